#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "log/named_columns.hpp"
#include "log/read_log.hpp"
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
  // What is proposed; positions and torques are there, or `missing` says what is not. Its
  // `velocity` has an entry per joint.
  ChannelMap channels;
  std::vector<std::string> missing;
  std::vector<std::string> notes;  // why, and what to look at

  [[nodiscard]] bool is_complete() const { return missing.empty(); }
};

// Reads every column. `robot`, where there is one, says how many joints there are, and their
// limits. `period_s` stands for a time that no column has. Throws InputError where the file cannot
// be read at all.
[[nodiscard]] Look look_at(const std::filesystem::path& path, const RobotDescription* robot,
                           std::optional<double> period_s);

}  // namespace offnominal::desk
