#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <offnominal/finite.hpp>
#include <offnominal/model/effect.hpp>
#include <offnominal/model/effects/drive.hpp>
#include <offnominal/model/effects/friction.hpp>
#include <offnominal/model/effects/inertia.hpp>
#include <offnominal/model/effects/memory.hpp>
#include <offnominal/model/effects/torque_path.hpp>
#include <offnominal/model/effects/transmission.hpp>
#include <span>
#include <string_view>

namespace offnominal {

template <typename... Effects>
struct EffectTypes {};

// Every effect that a chain may have. A new effect is one struct in effects/ and its name here.
using AllEffects =
    EffectTypes<effects::ViscousFriction, effects::CoulombFriction, effects::FrictionAsymmetry,
                effects::TorqueOffset, effects::StribeckFriction, effects::QuadraticFriction,
                effects::RotorInertia, effects::TipPayload, effects::LinkMass,
                effects::JointStiffness, effects::CoggingTorque, effects::PeriodicDisturbance,
                effects::TemperatureDrift, effects::JointCoupling, effects::LoadDependentFriction,
                effects::TorqueScale, effects::Hysteresis, effects::TimeDelay, effects::GearLoss,
                effects::PositionTorque>;

// Those that recordings are searched for and that no chain can have.
using EffectsOutsideChains = EffectTypes<effects::JointElasticity, effects::Backlash>;

// What a user may know of an effect: all that its struct says of it.
struct EffectInfo {
  EffectKind kind;
  const char* name;  // in robot files and in results
  const char* formula;
  const char* words;        // a noun phrase: "friction proportional to speed"
  const char* motion_hint;  // the motion that shows it best, as an order: "reverse often"
  std::span<const ParameterInfo> parameters;
  EffectAction action;
  EffectTraits traits;

  // The first parameter of that quantity; null where there is none.
  [[nodiscard]] constexpr const ParameterInfo* find(Quantity quantity) const {
    for (const ParameterInfo& parameter : parameters) {
      if (parameter.quantity == quantity) return &parameter;
    }
    return nullptr;
  }
  // Several may act on one joint: each has its own period, or follows its own joint.
  [[nodiscard]] constexpr bool may_repeat() const {
    return find(Quantity::kCyclesPerPosition) != nullptr || is_periodic_in_time() ||
           find(Quantity::kJointNumber) != nullptr;
  }
  [[nodiscard]] constexpr bool is_periodic_in_time() const {
    return find(Quantity::kAngularFrequency) != nullptr;
  }
  // It acts on all that the drive gives together, not beside it.
  [[nodiscard]] constexpr bool acts_on_whole_drive() const {
    return action == EffectAction::kToldPerGiven || action == EffectAction::kDelay;
  }
  // Another value of a number that every model has: a mass, a torque constant.
  [[nodiscard]] constexpr bool is_known_quantity() const {
    return action == EffectAction::kPointMass || action == EffectAction::kToldPerGiven;
  }
};

namespace detail {

template <typename E>
[[nodiscard]] constexpr EffectAction action_of() {
  using Parameters = std::array<double, kMaxEffectParameters>;
  if constexpr (requires(Parameters p, JointInstant<double> at) { E::torque(p, at); }) {
    return EffectAction::kTorque;
  } else if constexpr (requires(Parameters p) { E::reflected_inertia(p); }) {
    return EffectAction::kReflectedInertia;
  } else if constexpr (requires(Parameters p, std::array<double, 3> m) { E::point_mass(p, m); }) {
    return EffectAction::kPointMass;
  } else if constexpr (requires(Parameters p) { E::most_friction_per_load(p); }) {
    return EffectAction::kFrictionPerLoad;
  } else if constexpr (requires(Parameters p) { E::told_per_given(p); }) {
    return EffectAction::kToldPerGiven;
  } else if constexpr (requires(Parameters p) { E::torque_of_state(p, 0.0); }) {
    return EffectAction::kTorqueOfState;
  } else if constexpr (requires(Parameters p) { E::delay_s(p); }) {
    return EffectAction::kDelay;
  } else {
    return EffectAction::kDisplacement;
  }
}

template <typename Visitor, typename... Effects>
constexpr bool visit_effect(EffectKind kind, Visitor&& visitor, EffectTypes<Effects...> /*all*/) {
  return ((kind == Effects::kKind && (visitor.template operator()<Effects>(), true)) || ...);
}

template <typename... Effects>
constexpr auto all_effect_infos(EffectTypes<Effects...> /*all*/) {
  return std::array<EffectInfo, sizeof...(Effects)>{EffectInfo{
      Effects::kKind, Effects::kName, Effects::kFormula, Effects::kWords, Effects::kMotionHint,
      Effects::kParameters, action_of<Effects>(), Effects::kTraits}...};
}

// The numbers of a parameter alone: a controller that checks a chain carries no texts for it.
struct AllowedRange {
  double min;
  double max;
};

template <typename E>
inline constexpr auto kAllowedRanges = [] {
  std::array<AllowedRange, E::kParameters.size()> ranges{};
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    ranges[i] = {E::kParameters[i].min, E::kParameters[i].max};
  }
  return ranges;
}();

template <typename Scalar>
[[nodiscard]] constexpr bool all_inside(const std::array<Scalar, kMaxEffectParameters>& parameters,
                                        std::span<const AllowedRange> ranges) {
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const auto value = static_cast<double>(parameters[i]);
    if (!is_finite(value) || value < ranges[i].min || value > ranges[i].max) return false;
  }
  return true;
}

}  // namespace detail

// Calls visitor.operator()<E>() with the effect's struct E. False for a number that is no effect.
template <typename Visitor>
constexpr bool visit_effect(EffectKind kind, Visitor&& visitor) {
  return detail::visit_effect(kind, visitor, AllEffects{});
}

inline constexpr auto kAllEffectInfos = detail::all_effect_infos(AllEffects{});
inline constexpr auto kInfosOutsideChains = detail::all_effect_infos(EffectsOutsideChains{});

// Whether a chain, and hence a robot file, may have an effect of that kind.
[[nodiscard]] constexpr bool chain_may_have(EffectKind kind) {
  return visit_effect(kind, []<typename E>() {});
}

// Null for a number that is no effect.
[[nodiscard]] constexpr const EffectInfo* info_of(EffectKind kind) {
  for (const EffectInfo& info : kAllEffectInfos) {
    if (info.kind == kind) return &info;
  }
  for (const EffectInfo& info : kInfosOutsideChains) {
    if (info.kind == kind) return &info;
  }
  return nullptr;
}

// Null for a name that is no effect's.
[[nodiscard]] constexpr const EffectInfo* info_named(std::string_view name) {
  for (const EffectInfo& info : kAllEffectInfos) {
    if (name == info.name) return &info;
  }
  for (const EffectInfo& info : kInfosOutsideChains) {
    if (name == info.name) return &info;
  }
  return nullptr;
}

// Fixed storage for the effects that a model knows.
template <typename Scalar, int Capacity>
struct EffectList {
  static_assert(Capacity <= std::numeric_limits<std::uint8_t>::max(), "size counts in 8 bits");
  std::array<Effect<Scalar>, static_cast<std::size_t>(Capacity)> items{};
  std::uint8_t size = 0;

  [[nodiscard]] constexpr std::span<const Effect<Scalar>> view() const {
    return {items.data(), static_cast<std::size_t>(size)};
  }
  // False, and nothing added, when the storage is full.
  [[nodiscard]] constexpr bool add(const Effect<Scalar>& effect) {
    if (size >= Capacity) return false;
    items[size++] = effect;
    return true;
  }
};

// Which of an effect's parameters is the first of that quantity; its parameter count where none is.
template <typename E, Quantity kQuantity>
inline constexpr std::size_t kPlaceOf = [] {
  std::size_t i = 0;
  while (i < E::kParameters.size() && E::kParameters[i].quantity != kQuantity) ++i;
  return i;
}();

// Which of them names another joint.
template <typename E>
inline constexpr std::size_t kSourceParameter = kPlaceOf<E, Quantity::kJointNumber>;
template <typename E>
inline constexpr bool kHasSource = kSourceParameter<E> < E::kParameters.size();

// Whether a motor's shaft may have an effect of that kind: a torque by its own motion, or inertia.
// What scales or delays the way from motor to joint, and what remembers, belongs to joints.
[[nodiscard]] constexpr bool motor_may_have(EffectKind kind) {
  bool may = false;
  visit_effect(kind, [&]<typename E>() {
    constexpr EffectAction kAction = detail::action_of<E>();
    may = !kHasSource<E> &&
          (kAction == EffectAction::kTorque || kAction == EffectAction::kReflectedInertia);
  });
  return may;
}

// The other joint that an effect with kHasSource names, from 0.
template <typename E, typename Scalar>
[[nodiscard]] constexpr int source_joint(
    const std::array<Scalar, kMaxEffectParameters>& parameters) {
  return static_cast<int>(parameters[kSourceParameter<E>]) - 1;
}

// False where an effect names another joint and that is none of `joint_count` joints, the effect's
// own one, or not a whole number.
template <typename Scalar>
[[nodiscard]] constexpr bool source_joint_valid(const Effect<Scalar>& effect, int joint_count) {
  bool valid = true;
  visit_effect(effect.kind, [&]<typename E>() {
    if constexpr (kHasSource<E>) {
      const Scalar number = effect.parameters[kSourceParameter<E>];
      valid = is_finite(number) && number >= 1 && number <= static_cast<Scalar>(joint_count);
      if (!valid) return;
      const int source = source_joint<E>(effect.parameters);
      valid = static_cast<Scalar>(source + 1) == number && source != effect.joint;
    }
  });
  return valid;
}

// What an effect takes of the load at most, per load; those of one joint must not add up to more
// than LoadDependentFriction::kMostFactor. 0 for an effect that does not depend on the load.
template <typename Scalar>
[[nodiscard]] constexpr Scalar most_friction_per_load(const Effect<Scalar>& effect) {
  Scalar most{};
  visit_effect(effect.kind, [&]<typename E>() {
    if constexpr (requires { E::most_friction_per_load(effect.parameters); }) {
      most = E::most_friction_per_load(effect.parameters);
    }
  });
  return most;
}

// True where every parameter is finite and inside its documented range, and a chain may have the
// effect.
template <typename Scalar>
[[nodiscard]] constexpr bool parameters_valid(const Effect<Scalar>& effect) {
  bool valid = false;
  visit_effect(effect.kind, [&]<typename E>() {
    valid = detail::all_inside(effect.parameters,
                               std::span<const detail::AllowedRange>(detail::kAllowedRanges<E>));
  });
  return valid;
}

}  // namespace offnominal
