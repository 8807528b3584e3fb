#include <fmt/format.h>

#include <cmath>

#include "replay/replay.hpp"

namespace offnominal::desk {
namespace {

std::string range_of(const IsolatedFault& fault, double factor, const std::string& unit) {
  const double size = factor * std::abs(fault.size);
  const double two = 2 * factor * fault.deviation;
  return fmt::format("{:.3g} {} ({:.3g} to {:.3g})", size, unit, size - two, size + two);
}

std::string what_it_is(const IsolatedFault& fault) {
  const bool more = fault.size >= 0;
  switch (fault.kind) {
    case FaultKind::kFriction:
      return (more ? "friction up by " : "friction down by ") + range_of(fault, 1, fault.unit);
    case FaultKind::kLostTorque:
      return (more ? "torque lost, " : "torque gained, ") + range_of(fault, 100, "%") +
             " of what the drive is told";
    case FaultKind::kOffset:
      return fmt::format("a constant torque of {}{} acts on it", more ? "" : "-",
                         range_of(fault, 1, fault.unit));
    case FaultKind::kPayload:
      return (more ? "payload gained, " : "payload lost, ") + range_of(fault, 1, fault.unit);
    case FaultKind::kContact:
      return fmt::format("contact with its link, torques of joints up to {:.3g} {}",
                         std::abs(fault.size), fault.unit);
    case FaultKind::kEncoderStuck:
      return "its encoder sticks";
    case FaultKind::kEncoderJump:
      return fmt::format("its encoder has jumped by {:.3g} {}", fault.size, fault.unit);
    case FaultKind::kLockedJoint:
      return fmt::format("locked, against up to {:.3g} {}", std::abs(fault.size), fault.unit);
    case FaultKind::kUnknown:
      break;
  }
  return "";
}

}  // namespace

std::string words_of(const IsolatedFault& fault, const Replay& replay) {
  const std::string how =
      fmt::format("{:.2f} s after the detection{}", fault.time_s - fault.detection_time_s,
                  fault.decided ? "" : ", not decided yet");
  if (fault.kind == FaultKind::kUnknown) {
    return fmt::format("Unknown: none of the faults that it can name fits, {}", how);
  }
  const auto joint = static_cast<std::size_t>(fault.joint);
  return fmt::format("Joint {} ({}): {}, {}, confidence {:.0f} %", joint + 1,
                     replay.joint_names[joint], what_it_is(fault), how, 100 * fault.confidence);
}

}  // namespace offnominal::desk
