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

namespace {

// Whether it explains the blocks of one joint about as well. `independent`: samples of the joint
// that what the other one leaves is worth.
bool as_good_on(Index joint, const RowLayout& layout, const RowLayout::Blocks& blocks,
                const VectorXd& mine, const VectorXd& other, double simplified,
                double independent) {
  VectorXd difference = VectorXd::Zero(blocks.count);
  double left = 0;
  for (std::size_t r = 0; r < layout.recording_count(); ++r) {
    const Index begin = layout.begin(r, joint);
    for (Index row = begin; row < begin + layout.samples(r); ++row) {
      const double own = mine[row] * mine[row];
      left += own;
      difference[blocks.of_row[static_cast<std::size_t>(row)]] += other[row] * other[row] - own;
    }
  }
  const double mean = difference.mean();
  const auto count = static_cast<double>(blocks.count);
  const double deviation = std::sqrt((difference.array() - mean).square().sum() / (count - 1));
  const double error = deviation * std::sqrt(correlation_samples(difference) / count);
  // Were the other one the truth and its formula a simplification, the chosen one, which has
  // nothing of what the formula leaves, would leave about as much.
  constexpr double kMoreThanLeft = 3;  // twice the rms
  const double allowed = std::min(simplified, kMoreThanLeft * left);
  if (!(mean <= kTellApart * error + allowed / count)) return false;
  // Energies of blocks have long tails, and hide in them that one leaves several times the other.
  // Were what the other one leaves its noise, that the chosen one takes so much of it would be
  // chance.
  constexpr double kLikelier = kTellApart * kTellApart / 2;
  const double others = left + difference.sum();
  return !(left > 0) || !(0.5 * independent * std::log(others / (left + allowed)) > kLikelier);
}

}  // namespace

bool as_good(const Data& data, const ModelFit& chosen, const ModelFit& alternative, double energy) {
  const RowLayout& layout = data.layout;
  const VectorXd mine = layout.weighted(chosen.residual, chosen.joint_weights);
  const VectorXd other = layout.weighted(alternative.residual, chosen.joint_weights);
  const double simplified = kLeftOfItself * kLeftOfItself * energy;
  // What takes as much away from another joint has not explained this one.
  for (Index joint = 0; joint < layout.joint_count(); ++joint) {
    if (!as_good_on(joint, layout, chosen.remainder.blocks, mine, other, simplified,
                    alternative.remainder.independent_samples[joint])) {
      return false;
    }
  }
  return true;
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

std::vector<Term> ripples_of(const Data& data, Index joint, std::span<const double> periods) {
  const double range = range_moved(data.recordings, joint);
  const double per_period = first_order_period(data.recordings[0].joint_type(joint));
  std::vector<Term> ripples;
  if (!(range > 0)) return ripples;
  for (const auto& effect : all_candidates()) {
    if (effect->spectrum() != EffectCandidate::Spectrum::kPosition) continue;
    if (!effect->applies_in_any(data.recordings, joint)) continue;
    for (const double count : periods) {
      ripples.push_back({effect.get(), joint, {count * per_period / range}});
    }
  }
  return ripples;
}

std::vector<Term> slow_ripples(const Data& data, Index joint) {
  constexpr std::array kPeriodsInRange{0.1, 0.2, 0.35, 0.5, 0.75, 1.0, 1.5};
  std::vector<Term> ripples = ripples_of(data, joint, kPeriodsInRange);
  if (data.recordings[0].joint_type(joint) == JointType::kRevolute) {
    // Nothing that turns is slower than the joint.
    std::erase_if(ripples, [](const Term& one) { return one.shape[0] < 1; });
  }
  return ripples;
}

}  // namespace offnominal::desk
