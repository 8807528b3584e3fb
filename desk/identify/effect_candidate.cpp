#include "identify/effect_candidate.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "compare/inverse_model.hpp"
#include "identify/effects/effects.hpp"
#include "identify/shape_grid.hpp"
#include "robot/read_effect.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

// What a share of the motion is a share of.
// `at_place`: of what every joint has, that of the effect's joint or motor.
template <typename AtPlace>
double scale_of(Quantity quantity, const std::vector<Workspace>& at, const AtPlace& at_place) {
  VectorXd of_joints(at[0].joint_count());
  switch (quantity) {
    case Quantity::kVelocity: {
      double speed = 0;
      for (const Workspace& one : at) speed = std::max(speed, at_place(one.top_speed));
      return speed;
    }
    case Quantity::kDistance:
      for (Index j = 0; j < of_joints.size(); ++j) of_joints[j] = range_moved(at, j);
      return at_place(of_joints);
    case Quantity::kTime:
      return longest_duration_s(at);
    default:
      throw std::logic_error("a search knows no share of that quantity");
  }
}

// Of the velocities of two joints, over all recordings.
double correlation_of(const std::vector<Workspace>& at, Index a, Index b) {
  double product = 0;
  double of_a = 0;
  double of_b = 0;
  for (const Workspace& one : at) {
    product += one.motion.dq.col(a).dot(one.motion.dq.col(b));
    of_a += one.motion.dq.col(a).squaredNorm();
    of_b += one.motion.dq.col(b).squaredNorm();
  }
  const double size = std::sqrt(of_a * of_b);
  return size > 0 ? product / size : 0;
}

// Other joints' motion, each by its number, counted from 1.
struct OtherJoints {
  std::vector<double> apart;    // not in step with the joint
  std::vector<double> in_step;  // the friction of the joint itself would show as one of theirs
};

OtherJoints other_joints(const std::vector<Workspace>& at, Index joint) {
  constexpr double kInStep = 0.97;
  OtherJoints others;
  for (Index k = 0; k < at[0].joint_count(); ++k) {
    if (k == joint || !moves_in_any(at, k)) continue;
    const bool is_apart = std::abs(correlation_of(at, joint, k)) < kInStep;
    (is_apart ? others.apart : others.in_step).push_back(static_cast<double>(k + 1));
  }
  return others;
}

bool is_sign_width(const ParameterInfo& parameter) {
  return std::string_view(parameter.name) == effects::kSmoothing.name;
}

}  // namespace

Regressor torque_of(const Workspace& at, const Effect<double>& effect) {
  const auto joint = static_cast<Index>(effect.joint);
  if (effect.of_motor) {
    const Motion motors = motor_motion(at.rigid, at.motion);
    const VectorXd torque = is_torque_effect(effect.kind)
                                ? torque_of_effect(effect, JointType::kRevolute, motors, at.start_s)
                                : VectorXd(reflected_inertia_of(effect) * motors.ddq.col(joint));
    Regressor regressor;
    for (const MovedJoint& moved : joints_of_motor(at.rigid, effect.joint)) {
      regressor.push_back({moved.joint, moved.motor_per_joint * torque});
    }
    return regressor;
  }
  switch (info_of(effect.kind)->action) {
    case EffectAction::kTorque:
    case EffectAction::kTorqueOfState:
      return {{joint, torque_of_effect(effect, at.joint_type(joint), at.motion, at.start_s)}};
    case EffectAction::kFrictionPerLoad:
      return {{joint, friction_of_load(effect, at.motion, at.load_torque.col(joint))}};
    case EffectAction::kReflectedInertia:
      return {{joint, reflected_inertia_of(effect) * at.motion.ddq.col(joint)}};
    case EffectAction::kPointMass: {
      const Eigen::MatrixXd torque = torque_of_inertial_effect(at.rigid, effect, at.motion);
      Regressor regressor;
      for (Index j = 0; j <= joint; ++j) regressor.push_back({j, torque.col(j)});
      return regressor;
    }
    default:
      throw std::logic_error("an effect without a torque of its own needs a class in effects/");
  }
}

std::vector<ShapePoint> product_grid(const std::vector<ShapeRange>& ranges) {
  std::vector<ShapePoint> points{{}};
  for (const ShapeRange& range : ranges) {
    std::vector<ShapePoint> longer;
    for (const ShapePoint& point : points) {
      for (const double value : range.grid) {
        longer.push_back(point);
        longer.back().push_back(value);
      }
    }
    points = std::move(longer);
  }
  return points;
}

bool ShapeRange::is_other_effect(double value) const {
  constexpr double kNearEnd = 1.02;
  if (!is_searched()) return false;
  return (other_effect == OtherEffectAt::kLowest && value < kNearEnd * grid.front()) ||
         (other_effect == OtherEffectAt::kHighest && value * kNearEnd > grid.back());
}

bool EffectCandidate::is_within_reach(const std::vector<Workspace>& /*at*/, Index /*joint*/,
                                      const VectorXd& /*coefficients*/,
                                      std::span<const double> shape,
                                      const std::vector<ShapeRange>& ranges) const {
  for (std::size_t i = 0; i < shape.size(); ++i) {
    if (ranges[i].is_other_effect(shape[i])) return false;
  }
  return true;
}

bool EffectCandidate::finds(const ParameterInfo& parameter) const {
  return parameter.required || parameter.searched.to > 0;
}

Index EffectCandidate::linear_count() const {
  return std::count_if(
      info_.parameters.begin(), info_.parameters.end(),
      [](const ParameterInfo& parameter) { return parameter.role == ParameterRole::kLinear; });
}

ShapeRange EffectCandidate::range_of(std::size_t parameter, JointType type) const {
  const ParameterInfo& info = info_.parameters[parameter];
  return {info.name, unit_of(info.quantity, of_motor() ? JointType::kRevolute : type), {}};
}

std::vector<ShapeRange> EffectCandidate::shapes(const std::vector<Workspace>& at,
                                                Index joint) const {
  std::vector<ShapeRange> ranges;
  for (std::size_t i = 0; i < info_.parameters.size(); ++i) {
    const ParameterInfo& info = info_.parameters[i];
    if (info.role != ParameterRole::kShape || !finds(info)) continue;
    ShapeRange range = range_of(i, at[0].joint_type(joint));
    if (info.as_seen) {
      const PositionSpan seen = positions_seen(at, joint);
      range.kind = ShapeRange::Kind::kDiscrete;
      if (info.quantity == Quantity::kPosition) range.grid = {seen.low};
      if (info.quantity == Quantity::kDistance && seen.high - seen.low >= info.min) {
        range.grid = {seen.high - seen.low};
      }
    } else if (info.quantity == Quantity::kJointNumber) {
      range.kind = ShapeRange::Kind::kDiscrete;
      // Where there is no other, who asks for it all the same has those in step.
      OtherJoints others = other_joints(at, joint);
      range.grid = std::move(others.apart.empty() ? others.in_step : others.apart);
    } else {
      range.kind = ShapeRange::Kind::kLogarithmic;
      const double scale = scale_of(
          info.quantity, at, [&](const VectorXd& of_joints) { return at_place(of_joints, joint); });
      range.grid = logarithmic_grid(info.searched.from * scale, info.searched.to * scale);
      range.other_effect = info.searched.other_effect;
    }
    ranges.push_back(std::move(range));
  }
  return ranges;
}

std::vector<Regressor> EffectCandidate::regressors(const Workspace& at, Index joint,
                                                   std::span<const double> shape) const {
  std::vector<Regressor> columns;
  const Index count = linear_count();
  for (Index i = 0; i < count; ++i) {
    columns.push_back(torque_of(at, effect(joint, VectorXd::Unit(count, i), shape, at.sign_width)));
  }
  return columns;
}

EffectCandidate::Parameters EffectCandidate::found_parameters(const VectorXd& coefficients,
                                                              std::span<const double> shape) const {
  Parameters values{};
  Index linear = 0;
  std::size_t next = 0;
  for (std::size_t i = 0; i < info_.parameters.size(); ++i) {
    const ParameterInfo& parameter = info_.parameters[i];
    if (parameter.role == ParameterRole::kLinear) {
      values[i] = coefficients[linear++];
    } else if (finds(parameter)) {
      values[i] = shape[next++];
    }
  }
  return values;
}

bool EffectCandidate::is_physical(const VectorXd& coefficients) const {
  Index linear = 0;
  for (const ParameterInfo& parameter : info_.parameters) {
    if (parameter.role != ParameterRole::kLinear) continue;
    const bool is_positive = info_.traits.sign != CoefficientSign::kEither || parameter.min >= 0;
    if (is_positive && !(coefficients[linear] > 0)) return false;
    ++linear;
  }
  return true;
}

namespace {

// Whether a joint moves in both directions, at a tenth of its top speed for a fiftieth of the time
// that it moves so fast.
bool turns_both_ways(const std::vector<Workspace>& recordings, Index joint) {
  constexpr double kSpeed = 0.1;
  constexpr double kTime = 0.02;
  double top = 0;
  for (const Workspace& at : recordings) top = std::max(top, at.top_speed[joint]);
  Index forward = 0;
  Index backward = 0;
  for (const Workspace& at : recordings) {
    const auto dq = at.motion.dq.col(joint).array();
    forward += (dq > kSpeed * top).count();
    backward += (dq < -kSpeed * top).count();
  }
  const double enough = kTime * static_cast<double>(forward + backward);
  return static_cast<double>(std::min(forward, backward)) > enough;
}

}  // namespace

bool EffectCandidate::applies(const Workspace& at, Index joint) const {
  if (info_.traits.is_before_sensor && !at.sees_drive(joint)) return false;
  if (info_.find(Quantity::kJointNumber) != nullptr) return at.joint_count() > 1;
  return info_.traits.needs_no_motion || at.top_speed[joint] > 0;
}

bool EffectCandidate::applies_in_any(const std::vector<Workspace>& at, Index joint) const {
  // What differs between the directions is a constant and a slope as any in one of them.
  if (info_.traits.needs_both_directions && !turns_both_ways(at, joint)) return false;
  if (info_.find(Quantity::kJointNumber) != nullptr && other_joints(at, joint).apart.empty()) {
    return false;
  }
  return std::any_of(at.begin(), at.end(),
                     [&](const Workspace& one) { return applies(one, joint); });
}

bool EffectCandidate::acts_at_rest(const Workspace& /*at*/, Index /*joint*/) const {
  return info_.traits.acts_at_rest && !info_.traits.counts_time;
}

EffectCandidate::Spectrum EffectCandidate::spectrum() const {
  if (info_.is_periodic_in_time()) return Spectrum::kTime;
  return info_.find(Quantity::kCyclesPerPosition) != nullptr ? Spectrum::kPosition
                                                             : Spectrum::kNone;
}

std::vector<NamedValue> EffectCandidate::parameters(JointType type, const VectorXd& coefficients,
                                                    std::span<const double> shape) const {
  const Parameters values = found_parameters(coefficients, shape);
  std::vector<NamedValue> named;
  for (std::size_t i = 0; i < info_.parameters.size(); ++i) {
    const ParameterInfo& parameter = info_.parameters[i];
    if (!finds(parameter)) continue;
    named.push_back({parameter.name, values[i], unit_of(parameter.quantity, type)});
  }
  return named;
}

Effect<double> EffectCandidate::effect(Index joint, const VectorXd& coefficients,
                                       std::span<const double> shape,
                                       const VectorXd& sign_width) const {
  Effect<double> made{info_.kind, static_cast<std::uint8_t>(joint),
                      found_parameters(coefficients, shape), of_motor()};
  Index moved = joint;
  for (std::size_t i = 0; i < info_.parameters.size(); ++i) {
    const ParameterInfo& parameter = info_.parameters[i];
    if (parameter.quantity == Quantity::kJointNumber) {
      moved = static_cast<Index>(made.parameters[i]) - 1;
    }
    if (finds(parameter)) continue;
    made.parameters[i] = is_sign_width(parameter) ? at_place(sign_width, moved)
                                                  : given_[i].value_or(parameter.default_value);
  }
  return made;
}

double EffectCandidate::at_place(const VectorXd& of_joints, Index joint) const {
  if (!of_motor()) return of_joints[joint];
  double sum = 0;
  for (const MovedJoint& moved : moved_) {
    sum += std::abs(moved.motor_per_joint) * of_joints[moved.joint];
  }
  return sum;
}

bool motor_may_be_searched(EffectKind kind) {
  if (!file_motor_may_have(kind)) return false;
  const auto has_own_class = [kind](auto family) { return family(kind) != nullptr; };
  return !has_own_class(drive_candidate) && !has_own_class(ripple_candidate);
}

Candidate candidate_of(EffectKind kind) {
  for (const auto family :
       {drive_candidate, payload_candidate, ripple_candidate, transmission_candidate}) {
    if (Candidate own = family(kind)) return own;
  }
  return std::make_unique<EffectCandidate>(kind);
}

const std::vector<std::unique_ptr<const EffectCandidate>>& all_candidates() {
  static const auto candidates = [] {
    std::vector<std::unique_ptr<const EffectCandidate>> all;
    for (const EffectInfo* info : file_effects()) all.push_back(candidate_of(info->kind));
    return all;
  }();
  return candidates;
}

}  // namespace offnominal::desk
