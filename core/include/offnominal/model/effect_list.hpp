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
#include <span>

namespace offnominal {

template <typename... Effects>
struct EffectTypes {};

// Every effect there is. A new effect is one struct in effects/ and its name here.
using AllEffects =
    EffectTypes<effects::ViscousFriction, effects::CoulombFriction, effects::FrictionAsymmetry,
                effects::TorqueOffset, effects::StribeckFriction, effects::QuadraticFriction,
                effects::RotorInertia, effects::TipPayload, effects::LinkMass,
                effects::JointStiffness, effects::CoggingTorque, effects::PeriodicDisturbance,
                effects::TemperatureDrift, effects::JointCoupling, effects::LoadDependentFriction,
                effects::TorqueScale, effects::Hysteresis, effects::TimeDelay>;

// What a user may know of an effect: its name, its formula and its parameters.
struct EffectInfo {
  EffectKind kind;
  const char* name;
  const char* formula;
  std::span<const ParameterInfo> parameters;
};

namespace detail {

template <typename Visitor, typename... Effects>
constexpr bool visit_effect(EffectKind kind, Visitor&& visitor, EffectTypes<Effects...> /*all*/) {
  return ((kind == Effects::kKind && (visitor.template operator()<Effects>(), true)) || ...);
}

template <typename... Effects>
constexpr auto all_effect_infos(EffectTypes<Effects...> /*all*/) {
  return std::array<EffectInfo, sizeof...(Effects)>{
      EffectInfo{Effects::kKind, Effects::kName, Effects::kFormula, Effects::kParameters}...};
}

}  // namespace detail

// Calls visitor.operator()<E>() with the effect's struct E. False for a number that is no effect.
template <typename Visitor>
constexpr bool visit_effect(EffectKind kind, Visitor&& visitor) {
  return detail::visit_effect(kind, visitor, AllEffects{});
}

inline constexpr auto kAllEffectInfos = detail::all_effect_infos(AllEffects{});

// Null for a number that is no effect.
[[nodiscard]] constexpr const EffectInfo* info_of(EffectKind kind) {
  for (const EffectInfo& info : kAllEffectInfos) {
    if (info.kind == kind) return &info;
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

// Which of an effect's parameters names another joint; its parameter count where none does.
template <typename E>
inline constexpr std::size_t kSourceParameter = [] {
  std::size_t i = 0;
  while (i < E::kParameters.size() && E::kParameters[i].quantity != Quantity::kJointNumber) ++i;
  return i;
}();
template <typename E>
inline constexpr bool kHasSource = kSourceParameter<E> < E::kParameters.size();

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

// True where every parameter is finite and inside its documented range.
template <typename Scalar>
[[nodiscard]] constexpr bool parameters_valid(const Effect<Scalar>& effect) {
  const EffectInfo* info = info_of(effect.kind);
  if (info == nullptr) return false;
  for (std::size_t i = 0; i < info->parameters.size(); ++i) {
    const auto value = static_cast<double>(effect.parameters[i]);
    const bool inside =
        is_finite(value) && value >= info->parameters[i].min && value <= info->parameters[i].max;
    if (!inside) return false;
  }
  return true;
}

}  // namespace offnominal
