#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace offnominal::desk {

/// What a unit measures, as far as recordings of a robot have it.
enum class Dimension : std::uint8_t {
  kTime,             // s
  kAngle,            // rad
  kLength,           // m
  kAngularVelocity,  // rad/s
  kVelocity,         // m/s
  kTorque,           // N m
  kForce,            // N
  kCurrent,          // A
  kVoltage,          // V
};

/// A unit that [channels] and the files themselves name: one of it is `factor` of its dimension's
/// own, which the list above has.
struct SourceUnit {
  std::string_view name;
  Dimension dimension;
  double factor;
};

/// What a channel of a recording becomes.
enum class ChannelQuantity : std::uint8_t {
  kTime,
  kPosition,  // of a joint, as the next two
  kVelocity,
  kTorque,
  kMotorPosition,  // motors turn
  kMotorVelocity,
  kMotorTorque,
  kCurrent,
};

/// Whether no more than the unit has to be said to have the quantity in SI units: "deg" of a
/// position, and not "A" of a torque.
[[nodiscard]] bool is_unit_of(const SourceUnit& unit, ChannelQuantity quantity);
/// The names of such units.
[[nodiscard]] const char* units_of(ChannelQuantity quantity);
/// The unit of the list above: "rad/s".
[[nodiscard]] const char* si_name(Dimension dimension);

/// The unit of that name, capitals counted ("mN" is no "MN"); null for one that is not known.
[[nodiscard]] const SourceUnit* find_unit(std::string_view name);

/// Its factor; 1 for a unit that is not known, and for none.
[[nodiscard]] double unit_factor(std::string_view name);

/// Units that a time may be in where s was said or taken for them, the one nearest to s first.
inline constexpr std::array<const char*, 3> kShortTimeUnits{"ms", "us", "ns"};
inline constexpr std::array<const char*, 3> kLongTimeUnits{"min", "h", "d"};

/// Whether a velocity that is `ratio` times the derivative of its position, the time taken for s,
/// shows that the time is in `unit`, a long one: closely, since rad/s beside degrees is 5 % off a
/// minute.
[[nodiscard]] bool shows_long_time_unit(double ratio, const char* unit);

}  // namespace offnominal::desk
