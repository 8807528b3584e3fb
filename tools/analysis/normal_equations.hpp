#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace offnominal::tools {

// The rows of a regression that belong to one joint: torque = columns * unknowns + known.
struct JointRows {
  std::size_t joint = 0;
  Eigen::MatrixXd columns;  // rows: samples, columns: unknowns
  Eigen::VectorXd target;   // measured torque minus what is known
};

// Sums of squares and products of the columns and, last, of the target, per joint and per group of
// samples (blocks of time, or parts held out). Everything that least squares, its standard errors
// and its error on other samples need follows from them.
class NormalEquations {
 public:
  // group_of[i]: the group of sample i, from 0; a negative one leaves the sample out.
  NormalEquations(const std::vector<JointRows>& rows, const std::vector<int>& group_of,
                  int group_count);

  [[nodiscard]] int group_count() const { return static_cast<int>(products_.size()); }
  [[nodiscard]] std::size_t joint_count() const {
    return products_.empty() ? 0 : products_[0].size();
  }
  // (unknowns + 1) squared, the target last.
  [[nodiscard]] const Eigen::MatrixXd& products(int group, std::size_t joint) const {
    return products_[static_cast<std::size_t>(group)][joint];
  }
  [[nodiscard]] Eigen::Index samples(int group) const {
    return samples_[static_cast<std::size_t>(group)];
  }

  // Sum over the groups but `left_out` (negative: none), every joint times its weight.
  [[nodiscard]] Eigen::MatrixXd sum(const std::vector<double>& joint_weights,
                                    int left_out = -1) const;

 private:
  std::vector<std::vector<Eigen::MatrixXd>> products_;  // [group][joint]
  std::vector<Eigen::Index> samples_;
};

// Squared norm of target - columns * x.
double squared_error(const Eigen::MatrixXd& products, const Eigen::VectorXd& x);

// Columns that the data cannot tell apart: `fixed` was left at its start for it.
struct Ambiguity {
  std::size_t fixed = 0;
  std::vector<std::size_t> others;  // empty: the column is always 0
};

struct LinearSolution {
  Eigen::VectorXd x;
  std::vector<bool> is_fixed;  // left at its start
  std::vector<Ambiguity> ambiguities;
  Eigen::MatrixXd inverse;  // of the normal matrix, prior included; rows of fixed unknowns are 0
  double cost = 0;          // weighted squared error plus the prior's
};

// One unknown's part in solve(): where it starts, its prior, and who gives way.
struct UnknownPrior {
  double start = 0;
  double precision = 0;    // 1 / variance of the prior around start, 0: none
  bool gives_way = false;  // fixed before others where the data cannot tell them apart
};

// Two columns are told apart where the sine of the angle between them is above about 0.07: the
// smallest singular value of the columns, each scaled to length 1, has to be at least this.
inline constexpr double kSmallestSingularValue = 0.05;

// Least squares with priors. Columns are scaled to length 1; while the smallest singular value of
// the scaled columns is below kSmallestSingularValue, one of the columns that span its direction is
// fixed at its start: the last of those that give way, else the last of all. Where that happens the
// solution is the one that changes least of what was there before.
LinearSolution solve(const Eigen::MatrixXd& products, const std::vector<UnknownPrior>& priors);

}  // namespace offnominal::tools
