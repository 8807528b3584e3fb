#pragma once

#include <cstdint>

namespace offnominal {

enum class JointType : std::uint8_t { kRevolute = 0, kPrismatic = 1 };

// The physical dimension of a parameter. What stands behind it depends on the joint: a revolute
// joint moves in rad and is driven in N m, a prismatic one in m and N.
enum class Quantity : std::uint8_t {
  kEffort,                    // N m, or N
  kEffortPerVelocity,         // N m s/rad, or N s/m
  kEffortPerVelocitySquared,  // N m s^2/rad^2, or N s^2/m^2
  kEffortPerPosition,         // N m/rad, or N/m
  kPosition,                  // rad, or m
  kDistance,                  // rad, or m: between two positions
  kVelocity,                  // rad/s, or m/s
  kReflectedInertia,          // kg m^2, or kg
  kMass,                      // kg
  kLength,                    // m
  kCyclesPerPosition,         // periods per turn (2 pi rad), or periods per m
  kAngularFrequency,          // rad/s of time
  kTime,                      // s
  kRatio,                     // 1
  kJointNumber,               // which other joint, counted from 1: a whole number without a unit
};

[[nodiscard]] constexpr const char* unit_of(Quantity quantity, JointType type) {
  const bool turns = type == JointType::kRevolute;
  switch (quantity) {
    case Quantity::kEffort:
      return turns ? "N m" : "N";
    case Quantity::kEffortPerVelocity:
      return turns ? "N m s/rad" : "N s/m";
    case Quantity::kEffortPerVelocitySquared:
      return turns ? "N m s^2/rad^2" : "N s^2/m^2";
    case Quantity::kEffortPerPosition:
      return turns ? "N m/rad" : "N/m";
    case Quantity::kPosition:
    case Quantity::kDistance:
      return turns ? "rad" : "m";
    case Quantity::kVelocity:
      return turns ? "rad/s" : "m/s";
    case Quantity::kReflectedInertia:
      return turns ? "kg m^2" : "kg";
    case Quantity::kMass:
      return "kg";
    case Quantity::kLength:
      return "m";
    case Quantity::kCyclesPerPosition:
      return turns ? "1/turn" : "1/m";
    case Quantity::kAngularFrequency:
      return "rad/s";
    case Quantity::kTime:
      return "s";
    case Quantity::kRatio:
      return "1";
    case Quantity::kJointNumber:
      return "";
  }
  return "";
}

}  // namespace offnominal
