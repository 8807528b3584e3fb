#include "explain/alternatives.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "explain/questions.hpp"
#include "identify/shape_grid.hpp"
#include "signal/correlation.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

bool as_good(const Data& data, const ModelFit& chosen, const ModelFit& alternative, double energy) {
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
  const double error = deviation * std::sqrt(correlation_samples(difference) / count);
  // Were the other one the truth and its formula a simplification, the chosen one, which has
  // nothing of what the formula leaves, would leave about as much.
  constexpr double kMoreThanLeft = 3;  // of a joint's energy: twice the rms
  const double simplified = kLeftOfItself * kLeftOfItself * energy;
  const double left = mine.squaredNorm() / static_cast<double>(layout.joint_count());
  return mean < kTellApart * error + std::min(simplified, kMoreThanLeft * left) / count;
}

bool is_nested(const Data& data, const ModelFit& baseline, const Term& inner, const Term& outer) {
  constexpr double kSine = 0.1;
  Remainder target = baseline.remainder;
  const MatrixXd inside = columns_of(data, inner);
  if (columns_of(data, outer).cols() <= inside.cols()) return false;
  for (Index c = 0; c < inside.cols(); ++c) {
    target.residual = target.beside_basis(target.weighted(inside.col(c)));
    target.energy = data.layout.energy(target.residual);
    const Evidence evidence = evidence_for(Judge(target), data, outer);
    if (!evidence.usable || 1 - evidence.gain > kSine * kSine) return false;
  }
  return true;
}

std::vector<Term> slow_ripples(const Data& data, Index joint) {
  constexpr std::array kPeriodsInRange{0.1, 0.2, 0.35, 0.5, 0.75, 1.0, 1.5};
  const double range = range_moved(data.recordings, joint);
  const double period = first_order_period(data.recordings[0].joint_type(joint));
  std::vector<Term> ripples;
  if (!(range > 0)) return ripples;
  for (const auto& effect : all_candidates()) {
    if (effect->spectrum() != EffectCandidate::Spectrum::kPosition) continue;
    if (!effect->applies_in_any(data.recordings, joint)) continue;
    for (const double periods : kPeriodsInRange) {
      ripples.push_back({effect.get(), joint, {periods * period / range}});
    }
  }
  return ripples;
}

}  // namespace offnominal::desk
