#pragma once

#include "log/named_columns.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// The time of a file's samples.
struct FileTime {
  Eigen::VectorXd t_s;  // counted from origin_s
  double origin_s = 0;  // not 0 where the file counts from 1970 and a double does not hold that
};

// As `channel` says, or every `period_s` where that is above 0. Takes the column. Throws InputError
// where it is missing, is no measurement of time, counts ms, us or ns since 1970 and nobody said
// so, does not ascend, or has a unit beside dates.
[[nodiscard]] FileTime time_of(NamedColumns& columns, const Channel& channel, double period_s);

}  // namespace offnominal::desk
