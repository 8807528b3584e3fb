#include "explain/questions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "explain/found_model.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double weighted_energy(const Data& data, const Term& term, const VectorXd& coefficients,
                       const VectorXd& weights) {
  const MatrixXd columns = columns_of(data, term);
  const VectorXd torque = data.layout.weighted(columns * coefficients, weights);
  return torque.squaredNorm();
}

double growth_of_log_likelihood(const VectorXd& before, const VectorXd& after,
                                const VectorXd& samples) {
  double sum = 0;
  for (Index joint = 0; joint < before.size(); ++joint) {
    if (!(before[joint] > 0) || !(after[joint] > 0)) continue;
    sum += samples[joint] * std::log(before[joint] / after[joint]);
  }
  return sum;
}

bool is_more_likely_at_any_speed(const Data& data, const ModelFit& without, const ModelFit& with,
                                 Index joint) {
  constexpr double kNextToReversal = 0.1;  // of the top speed
  const RowLayout& layout = data.layout;
  // Next to a reversal, and where the joint moves.
  VectorXd before = VectorXd::Zero(2);
  VectorXd after = VectorXd::Zero(2);
  VectorXd rows = VectorXd::Zero(2);
  for (std::size_t r = 0; r < data.recordings.size(); ++r) {
    const Workspace& at = data.recordings[r];
    const VectorXd speed = kept_samples(at.plan, at.motion.dq.col(joint)).cwiseAbs();
    for (Index i = 0; i < speed.size(); ++i) {
      const Index row = layout.begin(r, joint) + i;
      if (!layout.says_something(row)) continue;
      const Index regime = speed[i] < kNextToReversal * at.top_speed[joint] ? 0 : 1;
      before[regime] += without.residual[row] * without.residual[row];
      after[regime] += with.residual[row] * with.residual[row];
      rows[regime] += 1;
    }
  }
  const VectorXd samples = with.remainder.independent_samples[joint] / rows.sum() * rows;
  return growth_of_log_likelihood(before.cwiseSqrt(), after.cwiseSqrt(), samples) > 0;
}

Shown shown(const Data& data, const std::vector<Term>& terms, std::size_t which,
            const ModelFit& fit, const ModelFit& without) {
  const RowLayout& layout = data.layout;
  const VectorXd& weights = fit.joint_weights;
  const auto energy_of = [&](const VectorXd& residual) {
    return layout.weighted(residual, weights).squaredNorm();
  };
  const auto rows = static_cast<double>(layout.rows());
  Shown result;
  result.torque =
      std::sqrt(weighted_energy(data, terms[which], fit.coefficients[which], weights) / rows);
  result.apart =
      std::sqrt(std::max(0.0, energy_of(without.residual) - energy_of(fit.residual)) / rows);
  return result;
}

namespace {

// Rms of how far a motion is from itself so many samples later, over the motion's own.
double change_after(const VectorXd& q, Index lag) {
  const Index count = q.size() - lag;
  const VectorXd around = q.array() - q.mean();
  const double own = around.squaredNorm() / static_cast<double>(q.size());
  const double change = (q.tail(count) - q.head(count)).squaredNorm() / static_cast<double>(count);
  return own > 0 ? std::sqrt(change / own) : 0;
}

}  // namespace

bool repeats_with_motion(const Data& data, const Term& term) {
  constexpr int kHighest = 8;    // harmonic of the motion that a torque of its state shows
  constexpr double kSame = 0.5;  // of the motion: a gait is not the same from step to step
  constexpr double kComesBack = 2;
  if (term.effect->spectrum() != EffectCandidate::Spectrum::kTime) return false;
  const double cycle_s = 2 * std::numbers::pi / term.shape[0];  // of an angular frequency
  bool any = false;
  for (const Workspace& at : data.recordings) {
    const VectorXd q = at.motion.q.col(term.joint);
    if (q.size() < 4 || q.minCoeff() == q.maxCoeff()) continue;
    any = true;
    const auto repeats_after = [&](int cycles) {
      const auto lag = static_cast<Index>(std::llround(cycles * cycle_s / at.period_s()));
      // What hardly moves meanwhile does not repeat.
      if (lag < 2 || 2 * lag > q.size()) return false;
      const double change = change_after(q, lag);
      return change < kSame && change_after(q, lag / 2) > std::max(kSame, kComesBack * change);
    };
    bool repeats = false;
    for (int cycles = 1; cycles <= kHighest && !repeats; ++cycles) repeats = repeats_after(cycles);
    if (!repeats) return false;
  }
  return any;
}

double smallest_shown(const Data& data, const ModelFit& at, const Screened& one) {
  // Gain in log-likelihood: a p of 1 % over some thousand places where an effect may be.
  constexpr double kAsked = 10;
  constexpr double kNothing = 1e-3;
  const RowLayout& layout = data.layout;
  const Index joint = one.term.joint;
  const VectorXd torque = columns_of(data, one.term) * one.evidence.coefficients;
  const VectorXd weighted = at.remainder.weighted(torque);
  const double whole = layout.energy(weighted)[joint];
  const double apart = layout.energy(at.remainder.beside_basis(weighted).col(0))[joint];
  if (!(apart > kNothing * kNothing * whole)) return std::numeric_limits<double>::infinity();
  const double share = std::sqrt(apart / whole);
  const double left = layout.rms(at.residual)[joint];
  const double samples = std::max(1.0, at.remainder.independent_samples[joint]);
  const double likely = std::sqrt(std::expm1(2 * kAsked / samples));
  const double relevant = std::sqrt(kRelevantShare / (1 - kRelevantShare));
  return std::max(left * std::max(likely, relevant) / share,
                  kRelevantTorque * layout.rms(data.torque)[joint]);
}

}  // namespace offnominal::desk
