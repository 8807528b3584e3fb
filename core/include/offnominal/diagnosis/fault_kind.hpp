#pragma once

#include <cstddef>
#include <cstdint>
#include <offnominal/model/quantity.hpp>

namespace offnominal {

// What a robot that is off nominal has. The numbers are stable.
enum class FaultKind : std::uint8_t {
  kUnknown = 0,     // none of the others is what is seen
  kFriction = 1,    // of one joint; size: what its motion loses more, at the speeds seen, N m or N
  kLostTorque = 2,  // of one joint's drive; size: share of the torque told that does not arrive
  kOffset = 3,      // of one joint; size: constant torque that acts on it, N m or N
  kPayload = 4,     // a body on the last link, gained (> 0) or lost (< 0); size: its mass, kg
  kContact = 5,     // a push on a link: torques on its joint and those before it; size: largest
  kEncoderStuck = 6,  // one joint's position no longer changes; no size
  kEncoderJump = 7,   // one joint's position is off from one sample on; size: by so much, rad or m
  kLockedJoint = 8,   // one joint does not move, whatever its drive gives; size: torque it holds
};
inline constexpr std::size_t kFaultKinds = 9;

// "unknown", "friction", "lost_torque", "offset", "payload", "contact", "encoder_stuck",
// "encoder_jump", "locked_joint".
[[nodiscard]] constexpr const char* name_of(FaultKind kind) {
  switch (kind) {
    case FaultKind::kUnknown:
      return "unknown";
    case FaultKind::kFriction:
      return "friction";
    case FaultKind::kLostTorque:
      return "lost_torque";
    case FaultKind::kOffset:
      return "offset";
    case FaultKind::kPayload:
      return "payload";
    case FaultKind::kContact:
      return "contact";
    case FaultKind::kEncoderStuck:
      return "encoder_stuck";
    case FaultKind::kEncoderJump:
      return "encoder_jump";
    case FaultKind::kLockedJoint:
      return "locked_joint";
  }
  return "unknown";
}

// Whether a torque of the drives may stand in for what the fault takes away. Not where something
// touches the arm or holds a joint, nor where an encoder says what is not so.
[[nodiscard]] constexpr bool is_compensated(FaultKind kind) {
  switch (kind) {
    case FaultKind::kUnknown:
    case FaultKind::kFriction:
    case FaultKind::kLostTorque:
    case FaultKind::kOffset:
    case FaultKind::kPayload:
      return true;
    case FaultKind::kContact:
    case FaultKind::kEncoderStuck:
    case FaultKind::kEncoderJump:
    case FaultKind::kLockedJoint:
      break;
  }
  return false;
}

// Of its size, on a joint of that type; empty where it has none.
[[nodiscard]] constexpr const char* size_unit_of(FaultKind kind, JointType type) {
  switch (kind) {
    case FaultKind::kFriction:
    case FaultKind::kOffset:
    case FaultKind::kContact:
    case FaultKind::kLockedJoint:
      return unit_of(Quantity::kEffort, type);
    case FaultKind::kLostTorque:
      return unit_of(Quantity::kRatio, type);
    case FaultKind::kPayload:
      return unit_of(Quantity::kMass, type);
    case FaultKind::kEncoderJump:
      return unit_of(Quantity::kPosition, type);
    case FaultKind::kUnknown:
    case FaultKind::kEncoderStuck:
      break;
  }
  return "";
}

}  // namespace offnominal
