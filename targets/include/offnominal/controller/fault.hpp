#pragma once

#include <cstdint>
#include <offnominal/hal/status.hpp>
#include <offnominal/status.hpp>

namespace offnominal::controller {

// Why a controller is in its safe state, or was not armed. One number space with offnominal::Status
// and hal::Status, so that one byte of a heartbeat says it all; docs/troubleshooting.md has a
// paragraph for each.
enum class Fault : std::uint8_t {
  kNone = 0,
  kEncoderSilent = 160,     // no fresh reading of a joint for longer than its source's max_age_us
  kEncoderUntrusted = 161,  // readings came, but with wrong CRCs or counters
  kDriveSilent = 162,       // the same of a drive's status
  kDriveUntrusted = 163,
  kDriveReported = 164,  // a drive says that it or its encoder has failed
  kEmergencyStop = 165,  // somebody asked for it, on the bus or here
  kBusLost = 166,        // bus-off, or the interface is gone
  kOverrun = 167,        // more ticks in a row were late than are allowed, or one by more periods
  kDetected = 168,       // the monitor's threshold was crossed, and the configuration says to stop
  kDriveNotFollowing = 169,    // a drive is not in the mode that it was told to take
  kReferenceOutOfRange = 170,  // it is where the joint cannot be, or faster than it may be
  kVelocityUnknown = 171,      // too many positions in a row are missing to observe it from
  kArmNotHeld = 172,           // armed, it left where it was, or was not at rest in time

  // Why arm() changed nothing; a fault where it comes to be between arm() and the first torque.
  kNotPassive = 180,           // in another state
  kNoFreshSample = 181,        // the last tick had no reading of every joint
  kVelocityUnsettled = 182,    // observed velocities are not settled yet
  kNoGains = 183,              // a joint's kp or kd is 0
  kNoTorqueLimit = 184,        // a joint's torque has no limit
  kReferenceFarFromArm = 185,  // further than the position window
  kArmMoving = 186,            // a joint is faster than the arming speed
  kReferenceMoving = 187,      // its velocity is another than the arm's, by more than that
};

// The number of a status of the core that made the controller stop: a sample that the monitor
// refused.
[[nodiscard]] constexpr Fault fault_of(Status status) { return static_cast<Fault>(status); }

// Whether a refusal of arm() ends by waiting: all that is missing is to be heard.
[[nodiscard]] constexpr bool passes_by_itself(Fault refusal) {
  return refusal == Fault::kNotPassive || refusal == Fault::kNoFreshSample ||
         refusal == Fault::kVelocityUnsettled;
}

// The name of any number that a heartbeat's fault may hold; "Unknown" for others.
[[nodiscard]] constexpr const char* name_of(Fault fault) {
  switch (fault) {
    case Fault::kNone:
      return "None";
    case Fault::kEncoderSilent:
      return "EncoderSilent";
    case Fault::kEncoderUntrusted:
      return "EncoderUntrusted";
    case Fault::kDriveSilent:
      return "DriveSilent";
    case Fault::kDriveUntrusted:
      return "DriveUntrusted";
    case Fault::kDriveReported:
      return "DriveReported";
    case Fault::kEmergencyStop:
      return "EmergencyStop";
    case Fault::kBusLost:
      return "BusLost";
    case Fault::kOverrun:
      return "Overrun";
    case Fault::kDetected:
      return "Detected";
    case Fault::kDriveNotFollowing:
      return "DriveNotFollowing";
    case Fault::kReferenceOutOfRange:
      return "ReferenceOutOfRange";
    case Fault::kVelocityUnknown:
      return "VelocityUnknown";
    case Fault::kArmNotHeld:
      return "ArmNotHeld";
    case Fault::kNotPassive:
      return "NotPassive";
    case Fault::kNoFreshSample:
      return "NoFreshSample";
    case Fault::kVelocityUnsettled:
      return "VelocityUnsettled";
    case Fault::kNoGains:
      return "NoGains";
    case Fault::kNoTorqueLimit:
      return "NoTorqueLimit";
    case Fault::kReferenceFarFromArm:
      return "ReferenceFarFromArm";
    case Fault::kArmMoving:
      return "ArmMoving";
    case Fault::kReferenceMoving:
      return "ReferenceMoving";
  }
  constexpr std::uint8_t kFirstOfHal = 100;
  const auto number = static_cast<std::uint8_t>(fault);
  return number < kFirstOfHal ? offnominal::name_of(static_cast<Status>(number))
                              : hal::name_of(static_cast<hal::Status>(number));
}

}  // namespace offnominal::controller
