#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "log/named_columns.hpp"
#include "log/sampling.hpp"
#include "look/column_facts.hpp"
#include "look/name_guess.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

struct LookedColumn {
  std::string name;
  Role role = Role::kNone;
  std::string unit;        // as the file or the name has it; empty: not said
  bool file_says = false;  // the unit
  ColumnFacts facts;
};

// A quantity of a joint as the robot file's own channels read it, in SI units at the joint.
struct ReadChannel {
  std::string joint;
  std::string quantity;  // "position", "velocity", "torque", "sensor torque"
  std::string unit;
  std::string from;  // "motor_current `i_1` (mA)", "derived from the position"
  double low = 0;
  double high = 0;
};

// What was understood of a recording, and the [channels] that would read it.
struct Look {
  std::string file;
  bool has_names = true;
  std::vector<std::string> unread;  // columns that hold no numbers
  std::vector<LookedColumn> columns;
  std::map<std::string, Eigen::VectorXd> values;  // by name, for pictures
  std::vector<std::string> remarks;               // of the reader
  std::optional<Eigen::VectorXd> t_s;             // none: no column is the time, or it is none
  std::optional<Sampling> sampling;
  // What the robot file's own channels read, with its transmission; empty where it has none, or
  // where they do not read this recording.
  std::vector<ReadChannel> by_robot;
  // What is proposed, or, where there is `by_robot`, the robot file's own. Its positions and
  // torques are there, or `missing` says what is not; its `velocity` has an entry per joint.
  ChannelMap channels;
  bool guessed = false;             // by the numbers alone, names say nothing
  std::vector<std::string> to_add;  // lines of [channels] beside the robot file's own
  // Lines of [transmission] without which the channels are refused, as comments.
  std::vector<std::string> transmission;
  std::vector<std::string> missing;
  std::vector<std::string> notes;  // why, and what to look at

  [[nodiscard]] bool is_complete() const { return missing.empty(); }
};

// Reads every column. `path` may name several files of one recording, a.csv+b.csv. `robot`, where
// there is one, says how many joints there are, their names and limits, and its channels, where it
// has some, are what is looked at. `period_s` stands for a time that no column has. Throws
// InputError where the file cannot be read at all.
[[nodiscard]] Look look_at(const std::filesystem::path& path, const RobotDescription* robot,
                           std::optional<double> period_s);

}  // namespace offnominal::desk
