#include "analysis/intervals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/freedom.hpp"

namespace offnominal::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The linearisation says nothing any more of what is further off than a factor of about 7.
constexpr double kWidestLogarithm = 2;

std::string words_of_wide(double half_width) {
  constexpr double kAnything = 1000;
  const double factor = std::exp(half_width);
  return factor < kAnything ? fmt::format("known to a factor of about {:.2g} only", factor)
                            : "no interval: next to no influence on the torque";
}

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

// Covariance of the solution from the scores of the blocks, as if these were many.
MatrixXd robust_covariance(const NormalEquations& blocks, const LinearSolution& solution,
                           const VectorXd& x, const std::vector<double>& weights) {
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
  return solution.inverse * spread * solution.inverse;
}

// How strongly every unknown shows on every joint. Rows: unknowns, columns: joints.
MatrixXd shown_on_joints(const NormalEquations& blocks, const std::vector<double>& weights,
                         Index unknowns) {
  MatrixXd shown = MatrixXd::Zero(unknowns, static_cast<Index>(blocks.joint_count()));
  for (int block = 0; block < blocks.group_count(); ++block) {
    for (std::size_t joint = 0; joint < blocks.joint_count(); ++joint) {
      shown.col(static_cast<Index>(joint)) +=
          weights[joint] * blocks.products(block, joint).diagonal().head(unknowns);
    }
  }
  return shown;
}

// Per joint: the blocks, and the unknowns that act on it and that nobody knew anything of before.
std::vector<Freedom> freedom_of_joints(const MatrixXd& shown, int blocks,
                                       const std::vector<UnknownPrior>& priors,
                                       const std::vector<bool>& is_fixed) {
  std::vector<Freedom> of_joint;
  for (Index joint = 0; joint < shown.cols(); ++joint) {
    Freedom freedom{blocks, 0};
    for (std::size_t i = 0; i < priors.size(); ++i) {
      const bool by_data = !is_fixed[i] && !(priors[i].precision > 0);
      freedom.unknowns += by_data && shown(static_cast<Index>(i), joint) > 0;
    }
    of_joint.push_back(freedom);
  }
  return of_joint;
}

}  // namespace

Intervals intervals_of(const FitProblem& problem, const LinearSolution& solution,
                       const std::vector<double>& shapes, const std::vector<double>& weights) {
  const std::size_t linear_count = problem.unknowns().size();
  Intervals intervals{std::vector<HalfWidth>(linear_count), std::vector<HalfWidth>(shapes.size())};
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
  const MatrixXd shown = shown_on_joints(blocks, weights, x.size());
  const std::vector<Freedom> of_joint =
      freedom_of_joints(shown, block_count, priors, joint.is_fixed);
  const MatrixXd covariance = robust_covariance(blocks, joint, x, weights);
  const auto half_width = [&](std::size_t i) -> HalfWidth {
    const auto index = static_cast<Index>(i);
    if (joint.is_fixed[i]) {
      return {std::nullopt, "no interval: close to its value the others make up for any change"};
    }
    Index of = 0;
    shown.row(index).maxCoeff(&of);
    const Freedom& freedom = of_joint[static_cast<std::size_t>(of)];
    if (!freedom.suffices()) {
      return {std::nullopt, words_of_too_few(freedom, rows[static_cast<std::size_t>(of)].joint)};
    }
    const double deviation = std::sqrt(std::max(covariance(index, index), 0.0));
    return {half_width_per_deviation(freedom) * deviation, {}};
  };
  for (std::size_t i = 0; i < linear_count; ++i) {
    if (!solution.is_fixed[i]) intervals.linear[i] = half_width(i);
  }
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const ShapeGroup& group = problem.groups()[i];
    if (group.search == ShapeGroup::Search::kDiscrete) {
      intervals.shape[i].why_none = "chosen among whole numbers";
      continue;
    }
    intervals.shape[i] = half_width(linear_count + i);
    const auto& width = intervals.shape[i].value;
    if (width && group.logarithmic && *width > kWidestLogarithm) {
      intervals.shape[i] = {std::nullopt, words_of_wide(*width)};
    }
  }
  return intervals;
}

}  // namespace offnominal::tools
