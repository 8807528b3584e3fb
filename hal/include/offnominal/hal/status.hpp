#pragma once

#include <cstdint>

namespace offnominal::hal {

// Result of every call of this layer that can refuse or fail. The numbers are stable, go over the
// bus and never meet those of offnominal::Status; docs/troubleshooting.md has a paragraph for each.
enum class Status : std::uint8_t {
  kOk = 0,

  // A frame that is not taken (100..119).
  kUnknownId = 100,
  kNotADataFrame = 101,
  kWrongFormat = 102,
  kWrongLength = 103,
  kWrongCrc = 104,
  kRepeatedCounter = 105,
  kSkippedCounter = 106,
  kInvalidValue = 107,
  kNotSynchronised = 108,

  // A frame that is not sent (120..129).
  kQueueFull = 120,
  kDeadlinePassed = 121,
  kFrameNotSupported = 122,

  // The bus itself (130..149).
  kBusOff = 130,
  kInterfaceDown = 131,
  kNoSuchInterface = 132,
  kNotPermitted = 133,
  kSystemError = 134,

  // A driver's configuration that validate() refuses (150..159).
  kInvalidNode = 150,
  kInvalidScale = 151,
  kInvalidInterval = 152,
};

// The name of a status as it stands above, without the leading k; "Unknown" for any other number.
[[nodiscard]] constexpr const char* name_of(Status status) {
  switch (status) {
    case Status::kOk:
      return "Ok";
    case Status::kUnknownId:
      return "UnknownId";
    case Status::kNotADataFrame:
      return "NotADataFrame";
    case Status::kWrongFormat:
      return "WrongFormat";
    case Status::kWrongLength:
      return "WrongLength";
    case Status::kWrongCrc:
      return "WrongCrc";
    case Status::kRepeatedCounter:
      return "RepeatedCounter";
    case Status::kSkippedCounter:
      return "SkippedCounter";
    case Status::kInvalidValue:
      return "InvalidValue";
    case Status::kNotSynchronised:
      return "NotSynchronised";
    case Status::kQueueFull:
      return "QueueFull";
    case Status::kDeadlinePassed:
      return "DeadlinePassed";
    case Status::kFrameNotSupported:
      return "FrameNotSupported";
    case Status::kBusOff:
      return "BusOff";
    case Status::kInterfaceDown:
      return "InterfaceDown";
    case Status::kNoSuchInterface:
      return "NoSuchInterface";
    case Status::kNotPermitted:
      return "NotPermitted";
    case Status::kSystemError:
      return "SystemError";
    case Status::kInvalidNode:
      return "InvalidNode";
    case Status::kInvalidScale:
      return "InvalidScale";
    case Status::kInvalidInterval:
      return "InvalidInterval";
  }
  return "Unknown";
}

}  // namespace offnominal::hal
