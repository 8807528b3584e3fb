#include "analysis/intervals.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

namespace offnominal::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kWidestLogarithm = 2;  // a factor of about 7 either way: not determined

// Blocks of equal length, in samples; the last one is the longest.
std::vector<int> blocks_of(Index samples, Index length, int& count) {
  count = static_cast<int>(std::max<Index>(1, samples / length));
  std::vector<int> block_of(static_cast<std::size_t>(samples));
  for (std::size_t i = 0; i < block_of.size(); ++i) {
    block_of[i] = std::min(static_cast<int>(static_cast<Index>(i) / length), count - 1);
  }
  return block_of;
}

// Change of the model torque with each group's value (or its logarithm), per row set.
std::vector<MatrixXd> shape_columns(const FitProblem& problem, const VectorXd& x,
                                    const std::vector<double>& shapes) {
  constexpr double kRelativeStep = 1e-3;
  const auto count = static_cast<Index>(shapes.size());
  std::vector<MatrixXd> columns(problem.joints().size(), MatrixXd::Zero(problem.samples(), count));
  for (std::size_t group = 0; group < shapes.size(); ++group) {
    if (problem.groups()[group].search == ShapeGroup::Search::kDiscrete) continue;
    const bool logarithmic = problem.groups()[group].logarithmic;
    const double size = std::abs(shapes[group]);
    const double step = logarithmic ? kRelativeStep * size : kRelativeStep * std::max(size, 1e-3);
    std::vector<double> above = shapes;
    std::vector<double> below = shapes;
    above[group] += step;
    below[group] -= step;
    const double width = 2 * (logarithmic ? step / size : step);
    const std::vector<JointRows> rows_above = problem.rows(above);
    const std::vector<JointRows> rows_below = problem.rows(below);
    for (std::size_t joint = 0; joint < columns.size(); ++joint) {
      columns[joint].col(static_cast<Index>(group)) =
          ((rows_above[joint].columns - rows_below[joint].columns) * x -
           (rows_above[joint].target - rows_below[joint].target)) /
          width;
    }
  }
  return columns;
}

// Covariance of the solution from the scores of the blocks.
MatrixXd robust_covariance(const NormalEquations& blocks, const LinearSolution& solution,
                           const VectorXd& x, const std::vector<double>& weights,
                           Index free_count) {
  const Index n = x.size();
  MatrixXd spread = MatrixXd::Zero(n, n);
  for (int block = 0; block < blocks.group_count(); ++block) {
    VectorXd score = VectorXd::Zero(n);
    for (std::size_t joint = 0; joint < blocks.joint_count(); ++joint) {
      const MatrixXd& products = blocks.products(block, joint);
      score += weights[joint] * (products.col(n).head(n) - products.topLeftCorner(n, n) * x);
    }
    spread += score * score.transpose();
  }
  const double count = blocks.group_count();
  const double small_sample = count / (count - static_cast<double>(free_count));
  return small_sample * solution.inverse * spread * solution.inverse;
}

}  // namespace

Intervals intervals_of(const FitProblem& problem, const LinearSolution& solution,
                       const std::vector<double>& shapes, const std::vector<double>& weights) {
  const std::size_t linear_count = problem.unknowns().size();
  Intervals intervals{std::vector<std::optional<double>>(linear_count),
                      std::vector<std::optional<double>>(shapes.size())};
  std::vector<JointRows> rows = problem.rows(shapes);
  double correlation = 1;
  for (const JointRows& joint : rows) {
    correlation = std::max(correlation, correlation_samples(residual_of(joint, solution.x)));
  }
  const std::vector<MatrixXd> derivative = shape_columns(problem, solution.x, shapes);
  const auto n = static_cast<Index>(linear_count);
  const auto shape_count = static_cast<Index>(shapes.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].columns.conservativeResize(Eigen::NoChange, n + shape_count);
    rows[i].columns.rightCols(shape_count) = derivative[i];
  }
  VectorXd x = VectorXd::Zero(n + shape_count);
  x.head(n) = solution.x;

  const double second = 1 / problem.measured().plan.period_s();
  const auto length = static_cast<Index>(std::ceil(std::max(second, 3 * correlation)));
  int block_count = 0;
  const std::vector<int> block_of = blocks_of(problem.samples(), length, block_count);
  const NormalEquations blocks(rows, block_of, block_count);

  std::vector<UnknownPrior> priors = problem.priors();
  for (std::size_t i = 0; i < linear_count; ++i) {
    // What was left at its start stays there: an overwhelming prior.
    if (solution.is_fixed[i]) priors[i].precision = 1e30;
  }
  priors.resize(linear_count + shapes.size(), {0, 0, true});
  const LinearSolution joint = solve(blocks.sum(weights), priors);
  const auto free_count =
      static_cast<Index>(std::count(joint.is_fixed.begin(), joint.is_fixed.end(), false));
  if (block_count <= free_count) return intervals;

  const MatrixXd covariance = robust_covariance(blocks, joint, x, weights, free_count);
  const boost::math::students_t distribution(static_cast<double>(block_count - free_count));
  const double t = boost::math::quantile(distribution, 0.975);
  const auto half_width = [&](std::size_t i) -> std::optional<double> {
    if (joint.is_fixed[i] || (i < linear_count && solution.is_fixed[i])) return std::nullopt;
    const auto index = static_cast<Index>(i);
    return t * std::sqrt(std::max(covariance(index, index), 0.0));
  };
  for (std::size_t i = 0; i < linear_count; ++i) intervals.linear[i] = half_width(i);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const auto width = half_width(linear_count + i);
    const bool wide = width && problem.groups()[i].logarithmic && *width > kWidestLogarithm;
    if (!wide) intervals.shape[i] = width;
  }
  return intervals;
}

}  // namespace offnominal::tools
