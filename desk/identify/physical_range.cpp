#include "identify/physical_range.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "robot/friction_sign.hpp"

namespace offnominal::desk {
std::string PhysicalRange::words_at(double value) const {
  return value < min ? fmt::format("{:g} or more", min) : fmt::format("{:g} or less", max);
}

const char* PhysicalRange::usual_cause() const {
  return is_friction ? "friction takes energy out of a joint; this usually means that the sign of "
                       "the torque or of the velocity is wrong (scale = -1 in [channels]), or that "
                       "the model lacks something else"
                     : "this usually means that the model lacks something else";
}

PhysicalRange physical_range(EffectKind kind, std::size_t parameter) {
  const EffectTraits& traits = info_of(kind)->traits;
  const ParameterInfo& info = info_of(kind)->parameters[parameter];
  PhysicalRange range{info.min, info.max, takes_energy_out(traits, info)};
  if (range.is_friction) range.min = std::max(range.min, 0.0);
  return range;
}

bool contradicts(const PhysicalRange& range, const std::optional<Interval>& ci95,
                 double torque_share) {
  constexpr double kMatters = 0.02;
  const bool holds_an_end = ci95 && (*ci95)[1] >= range.min && (*ci95)[0] <= range.max;
  return !holds_an_end && torque_share > kMatters;
}

}  // namespace offnominal::desk
