#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "motion/design.hpp"
#include "report/page.hpp"

namespace offnominal::desk::motion {

// What names a design in its outputs.
struct DesignNames {
  std::string robot_file;
  std::vector<std::string> logs;  // that the separation before comes from
  std::string output;
  std::string command_line;
};

// t, q1..qn, dq1..dqn, ddq1..ddqn in SI units; what is read back is the same to the last bit.
std::string csv_of(const Motion& motion);

// What the motion does and what it is expected to tell, in a sentence or two.
std::string sentence_of(const RobotDescription& robot, const Design& design,
                        const DesignNames& names);

// docs/motion.md lists the keys. Joints count from 1.
nlohmann::ordered_json to_json(const RobotDescription& robot, const Design& design,
                               const DesignNames& names);

// For a terminal: the sentence, then the numbers.
std::string text_of(const RobotDescription& robot, const Design& design, const DesignNames& names);

// The same with the trajectory; every number on it is in to_json() or in the CSV file.
report::Page page_of(const RobotDescription& robot, const Design& design, const DesignNames& names);

// A joint of the motion against what it may use.
struct JointUse {
  std::string position_unit, velocity_unit, torque_unit;
  double low = 0;
  double high = 0;
  double top_speed = 0;
  double top_torque = 0;
};
JointUse use_of(const RobotDescription& robot, const Design& design, std::size_t joint);

}  // namespace offnominal::desk::motion
