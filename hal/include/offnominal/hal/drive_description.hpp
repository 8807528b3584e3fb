#pragma once

#include <cstddef>
#include <cstdint>
#include <offnominal/hal/bus/frame.hpp>
#include <offnominal/joint_count.hpp>
#include <span>

// How a drive protocol describes itself to robot files and to the programs that read them. Beside
// its DriveProtocol it has a struct without members:
//
//   kName                     as [drives] of a robot file names it
//   kHeader, kType            where the struct is, and its full name, for generated code
//   kKeys, kJointKeys         std::arrays of DriveKey: of all drives, and of the drive of a joint
//   kHasFd                    whether it carries several joints in a frame of CAN FD
//   kHasPositionsAlone        whether its drives may leave out velocities
//   kHasDbc                   whether hal/offnominal.dbc has its messages
//   Drives<N>                 its DriveProtocol for N joints, or for kAnyJoints
//   drives<N>(values, link, joints)   makes one of values that fault_of() does not refuse; joints:
//                             of kAnyJoints
//   fault_of(values, period)  what is wrong with values that are each in their range, for ticks of
//                             a period, s
//   busy_share(values, joints, format, period)  share of a bus's time that its frames take at
//                             most, at BitRates
//   reading_frame(joints, format)  a frame as its drives send most of them
//   heartbeat_in(frame, into)  whether that is a controller's own word on itself, and what it says;
//                             false throughout where the protocol has none
//   from_drives(values, into), from_controller(values, into)  filters of what either end sends;
//                             returns how many, at most kMostDriveFilters

namespace offnominal::hal {

// In place of the number of joints that a driver is for: one of run time, 1 to kMaxJoints.
inline constexpr auto kAnyJoints = static_cast<std::size_t>(kRuntimeJoints);
template <std::size_t Joints>
inline constexpr auto kMostDrives = static_cast<std::size_t>(kMostJoints<static_cast<int>(Joints)>);

// One T per joint; `joints` counts with kAnyJoints.
template <std::size_t Joints, typename T>
[[nodiscard]] constexpr PerJoint<static_cast<int>(Joints), T> per_joint(
    [[maybe_unused]] std::size_t joints) {
  PerJoint<static_cast<int>(Joints), T> values{};
  if constexpr (Joints == kAnyJoints) values.assign(joints, T{});
  return values;
}

// A key of [drives]. Every value is a number: a word is its place in `words`.
struct DriveKey {
  const char* name = "";
  const char* unit = "";  // "s"; empty: none
  const char* meaning = "";
  double least = 0;
  double most = 0;
  bool required = false;
  double otherwise = 0;  // where it is not required and left out
  bool whole = false;    // whole numbers alone
  bool differs = false;  // no two joints have the same
  std::span<const char* const> words{};
};

// What [drives] says, in the order of the protocol's keys.
struct DriveValues {
  std::span<const double> shared;     // of kKeys
  std::span<const double> of_joints;  // of kJointKeys, joint after joint
};

// The first thing that is wrong; `key` is null where nothing is.
struct DriveFault {
  const char* key = nullptr;
  const char* found = "";
  const char* allowed = "";
};

enum class FrameFormat : std::uint8_t {
  kClassic = 0,  // one frame per joint and message
  kFd = 1,       // up to 8 joints in one frame
};

// What a robot file does not say of drives.
struct DriveLink {
  Microseconds period_us = 1000;  // of a tick
  FrameFormat format = FrameFormat::kClassic;
};

inline constexpr std::size_t kMostDriveFilters = 32;

}  // namespace offnominal::hal
