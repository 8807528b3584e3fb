#include <algorithm>
#include <cmath>
#include <numbers>

#include "identify/effects/effects.hpp"
#include "identify/shape_grid.hpp"
#include "signal/quantile.hpp"

namespace offnominal::desk {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::VectorXd;

// Half a period between neighbouring positions, as they are apart mostly; per rad or m.
double highest_order_held(const Workspace& at, Index joint) {
  VectorXd q = at.motion.q.col(joint);
  std::sort(q.begin(), q.end());
  const VectorXd apart = q.tail(q.size() - 1) - q.head(q.size() - 1);
  std::vector<double> steps;
  for (const double step : apart) {
    if (step > 0) steps.push_back(step);
  }
  if (steps.empty()) return 0;
  const VectorXd all = Eigen::Map<const VectorXd>(steps.data(), static_cast<Index>(steps.size()));
  constexpr double kMostly = 0.9;
  return 0.5 / quantile(all, kMostly) * 2 * std::numbers::pi;
}

// Its grid is a spectrum over the position.
class Cogging final : public EffectCandidate {
 public:
  Cogging() : EffectCandidate(EffectKind::kCoggingTorque) {}
  std::vector<ShapeRange> shapes(const std::vector<Workspace>& at, Index joint) const override {
    const JointType type = at[0].joint_type(joint);
    const double per_unit = first_order_period(type);
    const double range = range_moved(at, joint) / per_unit;
    double highest = 0;
    for (const Workspace& one : at) {
      if (one.at_rest) highest = std::max(highest, highest_order_held(one, joint) / per_unit);
      const double slow = std::max(quantile(one.motion.dq.col(joint).cwiseAbs(), 0.3),
                                   0.05 * one.top_speed[joint]) /
                          per_unit;
      if (slow > 0) highest = std::max(highest, one.plan.torque_cutoff_hz / slow);
    }
    ShapeRange order = range_of(2, type);
    if (!(range > 0)) return {order};
    constexpr double kMost = 1500;
    const double step = 0.5 / range;
    const double last = std::min(highest, (2 / range) + kMost * step);
    for (double k = 2 / range; k <= last; k += step) order.grid.push_back(k);
    return {order};
  }
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> shape) const override {
    const double k = 2 * std::numbers::pi / first_order_period(at.joint_type(joint));
    const ArrayXd phase = shape[0] * k * at.motion.q.col(joint).array();
    std::vector<Regressor> columns{{{joint, phase.sin().matrix()}},
                                   {{joint, phase.cos().matrix()}}};
    if (!at.both_ways(joint)) return columns;
    // Friction holds a joint a little before where the ripple would: by the direction of approach
    // the reading is shifted along it.
    for (std::size_t i = 0; i < 2; ++i) {
      columns.push_back(
          {{joint, columns[i][0].values.cwiseProduct(at.approach.col(joint)).eval()}});
    }
    return columns;
  }
};

// Its grid is a spectrum over time.
class Periodic final : public EffectCandidate {
 public:
  Periodic() : EffectCandidate(EffectKind::kPeriodicDisturbance) {}
  std::vector<ShapeRange> shapes(const std::vector<Workspace>& at, Index joint) const override {
    ShapeRange frequency = range_of(2, at[0].joint_type(joint));
    const double duration_s = longest_duration_s(at);
    // The filter's edge is no wall: a quarter above it a sixth of the amplitude is left, of effect
    // and regressor alike. Half the rate of what is kept is one.
    constexpr double kBeyondCutoff = 1.25;
    constexpr double kBelowHalfRate = 0.99;
    double highest_hz = 0;
    for (const Workspace& one : at) {
      highest_hz = std::max(highest_hz, std::min(kBeyondCutoff * one.plan.torque_cutoff_hz,
                                                 kBelowHalfRate * 0.5 / one.plan.period_s()));
    }
    const double whole = 2 * std::numbers::pi / duration_s;
    const double last = 2 * std::numbers::pi * highest_hz;
    constexpr double kMost = 4000;
    const double step = std::max(0.5 * whole, last / kMost);
    for (double w = 5 * whole; w < last; w += step) frequency.grid.push_back(w);
    return {frequency};
  }
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> shape) const override {
    const ArrayXd phase = shape[0] * (at.motion.t_s.array() - at.start_s);
    return {{{joint, phase.sin().matrix()}}, {{joint, phase.cos().matrix()}}};
  }
};

}  // namespace

Candidate ripple_candidate(EffectKind kind) {
  if (kind == EffectKind::kCoggingTorque) return std::make_unique<Cogging>();
  if (kind == EffectKind::kPeriodicDisturbance) return std::make_unique<Periodic>();
  return nullptr;
}

}  // namespace offnominal::desk
