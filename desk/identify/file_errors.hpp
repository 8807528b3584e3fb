#pragma once

#include <vector>

#include "compare/filter_plan.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// The errors that `offnominal compare` gives of a robot file on the recordings, all of them
// together, per joint: the one number that every verb tells of a file.
struct FileErrors {
  std::vector<double> rms_error;   // N m or N
  std::vector<double> rms_torque;  // of the measured torque
};

// Of recordings in time; `plan`: the filter of all of them.
FileErrors file_errors(const RobotDescription& robot, const std::vector<Log>& logs,
                       const FilterPlan& plan);

}  // namespace offnominal::desk
