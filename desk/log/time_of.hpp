#pragma once

#include <vector>

#include "log/named_columns.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// The time of a file's samples.
struct FileTime {
  Eigen::VectorXd t_s;                  // counted from origin_s
  std::vector<Eigen::Index> rows = {};  // that are left, where some do not ascend; empty: all
  Channel channel = {};  // as it was read, with the file's own unit; none of a period
  double origin_s = 0;   // not 0 where the file counts from 1970 and a double does not hold that
};

// As `channel` says, or every `period_s` where that is above 0. Takes the column. Throws InputError
// where it is missing, is no measurement of time, counts ms, us or ns since 1970 and nobody said
// so, or has a unit beside dates. Rows whose time does not ascend are left out of all columns, with
// a remark; where these are more than a few it does not ascend, and InputError is thrown.
[[nodiscard]] FileTime time_of(NamedColumns& columns, const Channel& channel, double period_s);

}  // namespace offnominal::desk
