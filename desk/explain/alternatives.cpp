#include "explain/alternatives.hpp"

#include <cmath>
#include <vector>

#include "identify/fit.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

bool as_good(const Data& data, const ModelFit& chosen, const ModelFit& alternative) {
  const RowLayout& layout = data.layout;
  const RowLayout::Blocks& blocks = chosen.remainder.blocks;
  const VectorXd mine = layout.weighted(chosen.residual, chosen.joint_weights);
  const VectorXd other = layout.weighted(alternative.residual, chosen.joint_weights);
  VectorXd difference = VectorXd::Zero(blocks.count);
  for (Index row = 0; row < mine.size(); ++row) {
    difference[blocks.of_row[static_cast<std::size_t>(row)]] +=
        other[row] * other[row] - mine[row] * mine[row];
  }
  const double mean = difference.mean();
  const auto count = static_cast<double>(blocks.count);
  const double deviation = std::sqrt((difference.array() - mean).square().sum() / (count - 1));
  return mean < kTellApart * deviation / std::sqrt(count);
}

bool is_nested(const Data& data, const ModelFit& baseline, const Term& inner, const Term& outer) {
  constexpr double kSine = 0.1;
  Remainder target = baseline.remainder;
  const MatrixXd outside = columns_of(data, outer);
  const MatrixXd inside = columns_of(data, inner);
  if (outside.cols() <= inside.cols()) return false;
  for (Index c = 0; c < inside.cols(); ++c) {
    target.residual = target.beside_basis(target.weighted(inside.col(c)));
    target.energy = data.layout.energy(target.residual);
    const Evidence evidence = judge(target, outside);
    if (!evidence.usable || 1 - evidence.gain > kSine * kSine) return false;
  }
  return true;
}

bool shows(const Data& data, const Excitation& motion, const Term& term) {
  constexpr double kApart = 0.3;
  if (motion.sufficient) return true;
  if (!motion.wide) return false;
  std::vector<std::vector<Regressor>> per_recording;
  for (const Workspace& at : data.recordings) {
    per_recording.push_back(standard_regressors(at, term.joint));
  }
  const std::size_t count = per_recording[0].size();
  MatrixXd standard(data.layout.rows(), static_cast<Index>(count));
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<Regressor> same;
    for (const std::vector<Regressor>& one : per_recording) same.push_back(one[i]);
    standard.col(static_cast<Index>(i)) = data.layout.stack(data.recordings, same);
  }
  const MatrixXd columns = columns_of(data, term);
  for (Index c = 0; c < columns.cols(); ++c) {
    const double length = columns.col(c).norm();
    const PriorFit fit =
        least_squares_with_priors(standard, columns.col(c), std::vector<Prior>(count), 1);
    if (fit.residual.norm() < kApart * length) return false;
  }
  return true;
}

}  // namespace offnominal::desk
