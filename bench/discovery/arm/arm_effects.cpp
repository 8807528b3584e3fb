#include "arm_effects.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace offnominal::bench {

using Eigen::Index;
using sim::hidden::Draws;

namespace {

using Numbers = std::vector<std::pair<std::string, double>>;

Numbers wave_numbers(double amplitude, const char* third, double value, Draws& draws) {
  const double phase = draws.uniform(0, 2 * std::numbers::pi);
  return {{"sine", amplitude * std::cos(phase)},
          {"cosine", amplitude * std::sin(phase)},
          {third, value}};
}

Numbers draw_friction(EffectKind kind, const ArmJointScale& joint, Draws& draws) {
  switch (kind) {
    case EffectKind::kCoulombFriction:
      return {{"level", joint.torque * draws.uniform(0.06, 0.15)}};
    case EffectKind::kViscousFriction:
      return {{"coefficient", joint.torque * draws.uniform(0.05, 0.12) / joint.speed}};
    case EffectKind::kQuadraticFriction:
      return {{"coefficient", joint.torque * draws.uniform(0.05, 0.12) / joint.speed2}};
    case EffectKind::kStribeckFriction: {
      const double level = joint.torque * draws.uniform(0.07, 0.15);
      return {{"level", level}, {"stribeck_velocity", draws.uniform(0.1, 0.4)}};
    }
    case EffectKind::kFrictionAsymmetry: {
      const double sign = draws.sign();
      const double level = sign * joint.coulomb * draws.uniform(0.3, 0.7);
      return {{"level", level}, {"coefficient", sign * joint.viscous * draws.uniform(0.3, 0.7)}};
    }
    case EffectKind::kLoadDependentFriction:
      return {{"factor", draws.uniform(0.05, 0.12)}};
    default: {
      const double level = joint.coulomb * draws.uniform(0.7, 1.5);
      const double coefficient = joint.viscous * draws.uniform(0.7, 1.5);
      return {
          {"level", level}, {"coefficient", coefficient}, {"time_constant", draws.uniform(6, 12)}};
    }
  }
}

Numbers draw_other(EffectKind kind, const ArmJointScale& joint, double other_speed, Index other,
                   Draws& draws) {
  const double share = draws.uniform(0.05, 0.12);
  switch (kind) {
    case EffectKind::kRotorInertia:
      return {{"inertia", joint.torque * share / joint.acceleration}};
    case EffectKind::kTorqueOffset:
      return {{"level", joint.torque * draws.either_sign(0.05, 0.12)}};
    case EffectKind::kTorqueScale:
      return {{"error", 1 / (1 + draws.either_sign(0.08, 0.2)) - 1}};
    case EffectKind::kJointStiffness: {
      const double rest = joint.middle + draws.uniform(-0.4, 0.4);
      const double reach = std::hypot(joint.spread, joint.middle - rest);
      return {{"stiffness", joint.torque * share / reach}, {"rest_position", rest}};
    }
    case EffectKind::kCoggingTorque: {
      const double order = 4 + draws.below(33);
      return wave_numbers(std::numbers::sqrt2 * joint.torque * share, "order", order, draws);
    }
    case EffectKind::kPeriodicDisturbance: {
      const double rad_s = 2 * std::numbers::pi * draws.log_uniform(1, 10);
      return wave_numbers(std::numbers::sqrt2 * joint.torque * share, "frequency", rad_s, draws);
    }
    case EffectKind::kJointCoupling:
      return {{"coefficient", draws.sign() * joint.torque * share / other_speed},
              {"level", 0},
              {"source_joint", static_cast<double>(other + 1)}};
    default:
      throw std::logic_error("no effect of the benchmark of arms");
  }
}

bool is_of_friction(EffectKind kind) {
  switch (kind) {
    case EffectKind::kCoulombFriction:
    case EffectKind::kViscousFriction:
    case EffectKind::kQuadraticFriction:
    case EffectKind::kStribeckFriction:
    case EffectKind::kFrictionAsymmetry:
    case EffectKind::kLoadDependentFriction:
    case EffectKind::kTemperatureDrift:
      return true;
    default:
      return false;
  }
}

}  // namespace

double ArmEffect::named(std::string_view name) const {
  const auto one = std::find_if(numbers.begin(), numbers.end(),
                                [&](const auto& number) { return number.first == name; });
  return one == numbers.end() ? 0 : one->second;
}

const std::vector<EffectKind>& arm_effect_kinds() {
  static const std::vector<EffectKind> kinds{
      EffectKind::kCoulombFriction,     EffectKind::kViscousFriction,
      EffectKind::kStribeckFriction,    EffectKind::kQuadraticFriction,
      EffectKind::kFrictionAsymmetry,   EffectKind::kLoadDependentFriction,
      EffectKind::kTemperatureDrift,    EffectKind::kRotorInertia,
      EffectKind::kTorqueOffset,        EffectKind::kTorqueScale,
      EffectKind::kJointStiffness,      EffectKind::kCoggingTorque,
      EffectKind::kPeriodicDisturbance, EffectKind::kJointCoupling};
  return kinds;
}

bool is_possible(EffectKind kind, const ArmJointScale& joint) {
  if (joint.speed == 0) return false;
  const bool loaded = joint.load > 0.6 * joint.torque;
  if (kind == EffectKind::kLoadDependentFriction || kind == EffectKind::kTorqueScale) return loaded;
  return true;
}

ArmEffect draw_arm_effect(EffectKind kind, Index joint, const std::vector<ArmJointScale>& scales,
                          Index other, Draws& draws) {
  const ArmJointScale& own = scales.at(static_cast<std::size_t>(joint));
  const double other_speed = scales.at(static_cast<std::size_t>(other)).speed;
  return {kind, joint,
          is_of_friction(kind) ? draw_friction(kind, own, draws)
                               : draw_other(kind, own, other_speed, other, draws),
          0};
}

}  // namespace offnominal::bench
