#include <cmath>

#include "identify/effects/effects.hpp"
#include "signal/differentiate.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// About the model as it is: what a scale multiplies is all that the model has.
class Scale final : public EffectCandidate {
 public:
  Scale() : EffectCandidate(EffectKind::kTorqueScale) {}
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> /*shape*/) const override {
    return {{{joint, at.model_torque.col(joint)}}};
  }
  // A drive that gives half of what it says, or half as much again, has another unit or gear: that
  // is no constant that is off, and what looks like it is mostly an inertia that is wrong.
  bool is_physical(const VectorXd& coefficients) const override {
    constexpr double kMost = 0.5;
    return std::abs(coefficients[0]) < kMost;
  }
};

// Linear in a small delay about none.
class Delay final : public EffectCandidate {
 public:
  Delay() : EffectCandidate(EffectKind::kTimeDelay) {}
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> /*shape*/) const override {
    return {{{joint, central_difference(at.model_torque.col(joint), at.period_s())}}};
  }
};

// Linear in stiffness and torque at q = 0, which together say the rest position.
class Stiffness final : public EffectCandidate {
 public:
  Stiffness() : EffectCandidate(EffectKind::kJointStiffness) {}
  std::vector<ShapeRange> shapes(const std::vector<Workspace>& /*at*/,
                                 Index /*joint*/) const override {
    return {};
  }
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> /*shape*/) const override {
    return {{{joint, at.motion.q.col(joint)}}, {{joint, VectorXd::Ones(at.sample_count())}}};
  }
  Parameters found_parameters(const VectorXd& coefficients,
                              std::span<const double> /*shape*/) const override {
    return {coefficients[0], -coefficients[1] / coefficients[0]};
  }
  // It pulls to its rest position: what pushes away from one, as a counterweight does, or gravity
  // that is off, is no spring.
  bool is_physical(const VectorXd& coefficients) const override { return coefficients[0] > 0; }
  // One whose rest lies far outside of the range moved is a constant torque with a slope.
  bool is_within_reach(const std::vector<Workspace>& at, Index joint, const VectorXd& coefficients,
                       std::span<const double> /*shape*/,
                       const std::vector<ShapeRange>& /*ranges*/) const override {
    constexpr double kRangesAway = 3;
    const auto [low, high] = positions_seen(at, joint);
    const double rest = -coefficients[1] / coefficients[0];
    const double slack = kRangesAway * (high - low);
    return rest >= low - slack && rest <= high + slack;
  }
  bool shape_is_coefficient(std::size_t parameter) const override { return parameter == 1; }

 protected:
  bool finds(const ParameterInfo& /*parameter*/) const override { return true; }
};

}  // namespace

Candidate drive_candidate(EffectKind kind) {
  if (kind == EffectKind::kTorqueScale) return std::make_unique<Scale>();
  if (kind == EffectKind::kTimeDelay) return std::make_unique<Delay>();
  if (kind == EffectKind::kJointStiffness) return std::make_unique<Stiffness>();
  return nullptr;
}

}  // namespace offnominal::desk
