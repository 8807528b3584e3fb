#include "log/usable_rows.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "common/error.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The first number that is none: its row, what it is of, and what is there.
struct Missing {
  Index row = -1;
  std::string what;
  double value = 0;
};

class RowCheck {
 public:
  explicit RowCheck(Index rows) : good_(static_cast<std::size_t>(rows), 1) {}

  void look_at(const Eigen::Ref<const VectorXd>& values, const std::string& what) {
    if (values.allFinite()) return;
    for (Index row = 0; row < values.size(); ++row) {
      if (std::isfinite(values[row])) continue;
      good_[static_cast<std::size_t>(row)] = 0;
      if (first_.row < 0 || row < first_.row) first_ = {row, what, values[row]};
    }
  }
  void look_at(const MatrixXd& columns, const char* quantity) {
    for (Index joint = 0; joint < columns.cols(); ++joint) {
      look_at(columns.col(joint), fmt::format("{} of joint {}", quantity, joint + 1));
    }
  }

  [[nodiscard]] const Missing& first() const { return first_; }
  [[nodiscard]] std::vector<Index> kept() const {
    std::vector<Index> rows;
    for (std::size_t row = 0; row < good_.size(); ++row) {
      if (good_[row] != 0) rows.push_back(static_cast<Index>(row));
    }
    return rows;
  }

 private:
  std::vector<char> good_;
  Missing first_;
};

VectorXd those(const VectorXd& values, const std::vector<Index>& kept) {
  VectorXd result(static_cast<Index>(kept.size()));
  for (Index i = 0; i < result.size(); ++i) result[i] = values[kept[static_cast<std::size_t>(i)]];
  return result;
}

void keep(MatrixXd& columns, const std::vector<Index>& kept) {
  if (columns.rows() == 0) return;
  MatrixXd result(static_cast<Index>(kept.size()), columns.cols());
  for (Index joint = 0; joint < columns.cols(); ++joint) {
    result.col(joint) = those(columns.col(joint), kept);
  }
  columns = std::move(result);
}

}  // namespace

std::vector<Index> ascending_rows(const VectorXd& t_s) {
  std::vector<Index> rows;
  double last = -std::numeric_limits<double>::infinity();
  for (Index row = 0; row < t_s.size(); ++row) {
    if (!(t_s[row] > last)) continue;
    last = t_s[row];
    rows.push_back(row);
  }
  return rows;
}

bool ascends_as_time(const VectorXd& values) {
  const auto rows = static_cast<double>(values.size());
  const auto ascending = static_cast<double>(ascending_rows(values).size());
  return ascending > 0 && rows - ascending <= kMostRowsOutOfTime * rows;
}

void keep_rows(NamedColumns& columns, Index rows, const std::vector<Index>& kept) {
  for (auto& [name, values] : columns.columns) {
    if (values.size() == rows) values = those(values, kept);
  }
  columns.place_of = [place_of = columns.place_of, kept](Index row) {
    return place_of(kept[static_cast<std::size_t>(row)]);
  };
}

void leave_out_rows_without_number(const NamedColumns& columns, Log& log) {
  const Index rows = log.t_s.size();
  RowCheck check(rows);
  check.look_at(log.q, "position");
  check.look_at(log.dq, "velocity");
  check.look_at(log.tau, "torque");
  if (log.sensor_tau.rows() > 0) check.look_at(log.sensor_tau, "sensor torque");
  for (const auto& [name, values] : log.extra) check.look_at(values, name);
  const Missing& first = check.first();
  if (first.row < 0) return;
  const std::vector<Index> kept = check.kept();
  const Index left_out = rows - static_cast<Index>(kept.size());
  const std::string place = columns.place_of(first.row) + ", " + first.what;
  const std::string found = std::isnan(first.value) ? "NaN" : "an infinite number";
  if (static_cast<double>(left_out) > kMostRowsWithoutNumber * static_cast<double>(rows)) {
    throw InputError(
        {columns.file, place,
         fmt::format("{}, one of {} rows of {} without a number", found, left_out, rows),
         "finite numbers in half of the rows or more",
         "give channels that are not recorded together as files of their own, joined with +"});
  }
  log.remarks.push_back(fmt::format("{} row{} without a number {} left out: {} first, {}", left_out,
                                    left_out == 1 ? "" : "s", left_out == 1 ? "is" : "are", place,
                                    found));
  log.t_s = those(log.t_s, kept);
  keep(log.q, kept);
  keep(log.dq, kept);
  keep(log.tau, kept);
  keep(log.sensor_tau, kept);
  for (auto& [name, values] : log.extra) values = those(values, kept);
  std::vector<Index> numbers;
  for (const Index row : kept) numbers.push_back(log.row_number(row));
  log.row_numbers = std::move(numbers);
}

}  // namespace offnominal::desk
