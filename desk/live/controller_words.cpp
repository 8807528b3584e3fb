#include "live/controller_words.hpp"

#include <fmt/format.h>

namespace offnominal::desk::live {
namespace {

using controller::Fault;

// In few words what the number's paragraph in docs/troubleshooting.md says; empty: it is none of
// these.
const char* meaning_of(Fault fault) {
  switch (fault) {
    case Fault::kEncoderSilent:
      return "no reading of a joint comes any more: look at its encoder, cable and bus";
    case Fault::kEncoderUntrusted:
      return "readings of a joint come with wrong checksums or counters: look for noise, or for a "
             "second sender";
    case Fault::kDriveSilent:
      return "no status of a drive comes any more, its torque is unknown: look at the drive, its "
             "cable and the bus";
    case Fault::kDriveUntrusted:
      return "a drive's status comes with wrong checksums or counters: look for noise, or for a "
             "second sender";
    case Fault::kDriveReported:
      return "a drive says that it or its encoder has failed: look at its own error codes";
    case Fault::kEmergencyStop:
      return "somebody has asked for an emergency stop";
    case Fault::kBusLost:
      return "the controller is off the bus: look at its interface, cable and bit rate";
    case Fault::kOverrun:
      return "ticks began too late: look for what else runs on that machine";
    case Fault::kDetected:
      return "the monitor has detected, and the configuration says to stop then";
    case Fault::kDriveNotFollowing:
      return "a drive is not in torque mode any more: look whether it is enabled and hears "
             "commands";
    case Fault::kReferenceOutOfRange:
      return "the motion goes where a joint cannot be, or faster than it may: look for degrees, "
             "and "
             "for the joints' order";
    case Fault::kVelocityUnknown:
      return "too many positions in a row are missing to know how fast a joint is: look for lost "
             "frames and late ticks";
    case Fault::kArmNotHeld:
      return "once armed, the arm left where it was: look at gains, signs and the model's gravity";
    default:
      return "";
  }
}

}  // namespace

std::string words_of(Fault fault) {
  constexpr int kFirstOfHal = 100;
  const auto number = static_cast<int>(fault);
  std::string words = meaning_of(fault);
  if (words.empty() && number > 0 && number < kFirstOfHal) {
    words = "the monitor has refused a sample: look at what came before it";
  }
  if (words.empty() && fault >= Fault::kNotPassive && fault <= Fault::kReferenceMoving) {
    words = "what arming asks for was no longer so when it began";
  }
  const std::string where = fmt::format("number {} of docs/troubleshooting.md", number);
  return words.empty() ? where : words + " (" + where + ")";
}

}  // namespace offnominal::desk::live
