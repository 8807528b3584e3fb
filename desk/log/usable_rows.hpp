#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "log/log.hpp"
#include "log/named_columns.hpp"

// Rows that hold no sample: a number is missing, or a time does not ascend. They are left out, as
// if they had never been recorded, and the rest keeps the numbers that it has in the file.

namespace offnominal::desk {

// A share of all rows that may be left out; of more than these nobody knows what they are.
inline constexpr double kMostRowsWithoutNumber = 0.5;
inline constexpr double kMostRowsOutOfTime = 0.1;

// The rows at which time goes on from the last of them, from 0.
[[nodiscard]] std::vector<Eigen::Index> ascending_rows(const Eigen::VectorXd& t_s);

// Whether so many of the rows ascend that the rest may be left out.
[[nodiscard]] bool ascends_as_time(const Eigen::VectorXd& values);

// Of every column with `rows` values those of the rows that are kept; place_of() goes with them.
void keep_rows(NamedColumns& columns, Eigen::Index rows, const std::vector<Eigen::Index>& kept);

// Leaves out the rows of a log that is not sampled yet in which a number is not finite, and says so
// in a remark; `columns` are where it comes from. Throws InputError where that would be most of
// them.
void leave_out_rows_without_number(const NamedColumns& columns, Log& log);

}  // namespace offnominal::desk
