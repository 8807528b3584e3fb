#include "robot/units.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

namespace offnominal::desk {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kWholeTurn = 2 * std::numbers::pi;
constexpr double kRpm = std::numbers::pi / 30;
constexpr double kKilogramForce = 9.80665;  // N

constexpr auto kUnits = std::to_array<SourceUnit>({
    {"s", Dimension::kTime, 1},
    {"sec", Dimension::kTime, 1},
    {"ms", Dimension::kTime, 1e-3},
    {"us", Dimension::kTime, 1e-6},
    {"\u00b5s", Dimension::kTime, 1e-6},
    {"ns", Dimension::kTime, 1e-9},
    {"min", Dimension::kTime, 60},
    {"h", Dimension::kTime, 3600},
    {"d", Dimension::kTime, 86400},
    {"rad", Dimension::kAngle, 1},
    {"mrad", Dimension::kAngle, 1e-3},
    {"deg", Dimension::kAngle, kDegree},
    {"\u00b0", Dimension::kAngle, kDegree},
    {"turns", Dimension::kAngle, kWholeTurn},
    {"rev", Dimension::kAngle, kWholeTurn},
    {"m", Dimension::kLength, 1},
    {"cm", Dimension::kLength, 1e-2},
    {"mm", Dimension::kLength, 1e-3},
    {"um", Dimension::kLength, 1e-6},
    {"\u00b5m", Dimension::kLength, 1e-6},
    {"rad/s", Dimension::kAngularVelocity, 1},
    {"mrad/s", Dimension::kAngularVelocity, 1e-3},
    {"deg/s", Dimension::kAngularVelocity, kDegree},
    {"\u00b0/s", Dimension::kAngularVelocity, kDegree},
    {"rpm", Dimension::kAngularVelocity, kRpm},
    {"rev/min", Dimension::kAngularVelocity, kRpm},
    {"1/min", Dimension::kAngularVelocity, kRpm},
    {"turns/s", Dimension::kAngularVelocity, kWholeTurn},
    {"rev/s", Dimension::kAngularVelocity, kWholeTurn},
    {"m/s", Dimension::kVelocity, 1},
    {"cm/s", Dimension::kVelocity, 1e-2},
    {"mm/s", Dimension::kVelocity, 1e-3},
    {"m/min", Dimension::kVelocity, 1.0 / 60},
    {"mm/min", Dimension::kVelocity, 1e-3 / 60},
    {"Nm", Dimension::kTorque, 1},
    {"kNm", Dimension::kTorque, 1e3},
    {"Ncm", Dimension::kTorque, 1e-2},
    {"Nmm", Dimension::kTorque, 1e-3},
    {"mNm", Dimension::kTorque, 1e-3},
    {"uNm", Dimension::kTorque, 1e-6},
    {"kgfm", Dimension::kTorque, kKilogramForce},
    {"kgfcm", Dimension::kTorque, kKilogramForce * 1e-2},
    {"N", Dimension::kForce, 1},
    {"kN", Dimension::kForce, 1e3},
    {"mN", Dimension::kForce, 1e-3},
    {"A", Dimension::kCurrent, 1},
    {"mA", Dimension::kCurrent, 1e-3},
    {"V", Dimension::kVoltage, 1},
    {"mV", Dimension::kVoltage, 1e-3},
});

const SourceUnit* unit_named(std::string_view name) {
  const auto* found = std::find_if(kUnits.begin(), kUnits.end(),
                                   [&](const SourceUnit& unit) { return unit.name == name; });
  return found == kUnits.end() ? nullptr : found;
}

// "mN m", "mN*m", "mN\u00b7m" and "mN-m" as "mNm".
std::string without_product_signs(std::string_view name) {
  constexpr std::array<std::string_view, 10> kSigns{
      " ", "*", ".", "-", "\u00b7", "\u22c5", "\u2219", "\u2022", "\u00d7", "\u00a0"};
  std::string text;
  while (!name.empty()) {
    const auto* const sign = std::find_if(
        kSigns.begin(), kSigns.end(), [&](std::string_view one) { return name.starts_with(one); });
    if (sign == kSigns.end()) text += name.front();
    name.remove_prefix(sign == kSigns.end() ? 1 : sign->size());
  }
  for (const std::string_view micro : {"\u00b5", "\u03bc"}) {
    if (text.starts_with(micro)) text.replace(0, micro.size(), "u");
  }
  return text;
}

}  // namespace

bool is_unit_of(const SourceUnit& unit, ChannelQuantity quantity) {
  const Dimension of = unit.dimension;
  switch (quantity) {
    case ChannelQuantity::kTime:
      return of == Dimension::kTime;
    case ChannelQuantity::kPosition:
      return of == Dimension::kAngle || of == Dimension::kLength;
    case ChannelQuantity::kVelocity:
      return of == Dimension::kAngularVelocity || of == Dimension::kVelocity;
    case ChannelQuantity::kTorque:
      return of == Dimension::kTorque || of == Dimension::kForce;
    case ChannelQuantity::kMotorPosition:
      return of == Dimension::kAngle;
    case ChannelQuantity::kMotorVelocity:
      return of == Dimension::kAngularVelocity;
    case ChannelQuantity::kMotorTorque:
      return of == Dimension::kTorque;
    case ChannelQuantity::kCurrent:
      return of == Dimension::kCurrent;
  }
  return false;
}

const char* units_of(ChannelQuantity quantity) {
  switch (quantity) {
    case ChannelQuantity::kTime:
      return "s, ms, us, ns, min, h, d";
    case ChannelQuantity::kPosition:
      return "rad, mrad, deg, turns, m, cm, mm, um";
    case ChannelQuantity::kVelocity:
      return "rad/s, mrad/s, deg/s, rpm, turns/s, m/s, cm/s, mm/s, m/min, mm/min";
    case ChannelQuantity::kTorque:
      return "Nm, kNm, Ncm, Nmm, mNm, uNm, kgfm, kgfcm, N, kN, mN";
    case ChannelQuantity::kMotorPosition:
      return "rad, mrad, deg, turns";
    case ChannelQuantity::kMotorVelocity:
      return "rad/s, mrad/s, deg/s, rpm, turns/s";
    case ChannelQuantity::kMotorTorque:
      return "Nm, kNm, Ncm, Nmm, mNm, uNm, kgfm, kgfcm";
    case ChannelQuantity::kCurrent:
      return "A, mA";
  }
  return "";
}

const char* si_name(Dimension dimension) {
  switch (dimension) {
    case Dimension::kTime:
      return "s";
    case Dimension::kAngle:
      return "rad";
    case Dimension::kLength:
      return "m";
    case Dimension::kAngularVelocity:
      return "rad/s";
    case Dimension::kVelocity:
      return "m/s";
    case Dimension::kTorque:
      return "Nm";
    case Dimension::kForce:
      return "N";
    case Dimension::kCurrent:
      return "A";
    case Dimension::kVoltage:
      return "V";
  }
  return "";
}

const SourceUnit* find_unit(std::string_view name) {
  const SourceUnit* const plain = unit_named(name);
  if (plain != nullptr) return plain;
  // Of a torque alone: "m s" is no millisecond.
  const SourceUnit* const product = unit_named(without_product_signs(name));
  return product != nullptr && product->dimension == Dimension::kTorque ? product : nullptr;
}

double unit_factor(std::string_view name) {
  const SourceUnit* unit = find_unit(name);
  return unit == nullptr ? 1 : unit->factor;
}

bool shows_long_time_unit(double ratio, const char* unit) {
  constexpr double kClosely = 1.02;
  return ratio > 0 && std::abs(std::log(ratio * unit_factor(unit))) < std::log(kClosely);
}

}  // namespace offnominal::desk
