#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <offnominal/model/effect.hpp>
#include <offnominal/model/effects/drive.hpp>
#include <offnominal/model/effects/friction.hpp>
#include <offnominal/model/effects/inertia.hpp>
#include <span>

namespace offnominal {

template <typename... Effects>
struct EffectTypes {};

// Every effect there is. A new effect is one struct in effects/ and its name here.
using AllEffects =
    EffectTypes<effects::ViscousFriction, effects::CoulombFriction, effects::FrictionAsymmetry,
                effects::TorqueOffset, effects::StribeckFriction, effects::QuadraticFriction,
                effects::RotorInertia, effects::TipPayload, effects::LinkMass,
                effects::JointStiffness, effects::CoggingTorque, effects::PeriodicDisturbance>;

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

// True where every parameter is finite and inside its documented range.
template <typename Scalar>
[[nodiscard]] constexpr bool parameters_valid(const Effect<Scalar>& effect) {
  const EffectInfo* info = info_of(effect.kind);
  if (info == nullptr) return false;
  for (std::size_t i = 0; i < info->parameters.size(); ++i) {
    const auto value = static_cast<double>(effect.parameters[i]);
    const bool inside = value >= info->parameters[i].min && value <= info->parameters[i].max;
    if (!inside) return false;
  }
  return true;
}

}  // namespace offnominal
