#pragma once

#include <cstdint>
#include <offnominal/hal/status.hpp>
#include <offnominal/status.hpp>

namespace offnominal::controller {

// Why a controller is in its safe state. One number space with offnominal::Status and hal::Status,
// so that one byte of a heartbeat says it all; docs/troubleshooting.md has a paragraph for each.
enum class Fault : std::uint8_t {
  kNone = 0,
  kEncoderSilent = 160,     // no fresh reading of a joint for longer than its source's max_age_us
  kEncoderUntrusted = 161,  // readings came, but with wrong CRCs or counters
  kDriveSilent = 162,       // the same of a drive's status
  kDriveUntrusted = 163,
  kDriveReported = 164,  // a drive says that it or its encoder has failed
  kEmergencyStop = 165,  // somebody asked for it, on the bus or here
  kBusLost = 166,        // bus-off, or the interface is gone
  kOverrun = 167,        // more ticks in a row were late than are allowed
  kDetected = 168,       // the monitor's threshold was crossed, and the configuration says to stop
  kDriveNotFollowing = 169,  // a drive is not in the mode that it was told to take
};

// The number of a status of the core that made the controller stop: a sample that the monitor
// refused.
[[nodiscard]] constexpr Fault fault_of(Status status) { return static_cast<Fault>(status); }

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
  }
  constexpr std::uint8_t kFirstOfHal = 100;
  const auto number = static_cast<std::uint8_t>(fault);
  return number < kFirstOfHal ? offnominal::name_of(static_cast<Status>(number))
                              : hal::name_of(static_cast<hal::Status>(number));
}

}  // namespace offnominal::controller
