// The drive protocols at run time: what robot files and programs ask of them.
#pragma once

#include <cstddef>
#include <memory>
#include <offnominal/hal/drive_description.hpp>
#include <offnominal/hal/messages.hpp>
#include <span>
#include <vector>

#include "drives/drive_settings.hpp"
#include "offnominal/sim/bus/drives.hpp"

namespace offnominal::desk {

/// One protocol; drive_description.hpp of hal says what its members are.
struct DriveProtocol {
  const char* name;
  const char* header;
  const char* type;
  std::span<const hal::DriveKey> keys;
  std::span<const hal::DriveKey> joint_keys;
  bool has_fd;
  bool has_positions_alone;
  bool has_dbc;
  hal::DriveFault (*fault_of)(const hal::DriveValues& values, double period_s);
  double (*busy_share)(const hal::DriveValues& values, std::size_t joints, hal::FrameFormat format,
                       double period_s);
  hal::Frame (*reading_frame)(std::size_t joints, hal::FrameFormat format);
  bool (*heartbeat_in)(const hal::Frame& frame, hal::Heartbeat& into);
  std::size_t (*from_drives)(const hal::DriveValues& values, std::span<hal::IdFilter> into);
  std::size_t (*from_controller)(const hal::DriveValues& values, std::span<hal::IdFilter> into);
  std::unique_ptr<sim::Drives> (*emulate)(const hal::DriveValues& values,
                                          const sim::DriveSetup& setup);
};

[[nodiscard]] std::span<const DriveProtocol> drive_protocols();

[[nodiscard]] const DriveProtocol& protocol_of(const DriveSettings& settings);
/// Valid as long as the settings are.
[[nodiscard]] hal::DriveValues values_of(const DriveSettings& settings);

/// What the drives send, and what a controller does: for the filters of a CAN interface.
[[nodiscard]] std::vector<hal::IdFilter> from_drives(const DriveSettings& settings);
[[nodiscard]] std::vector<hal::IdFilter> from_controller(const DriveSettings& settings);

/// Drives at the other end of a bus.
[[nodiscard]] std::unique_ptr<sim::Drives> emulated_drives(const DriveSettings& settings,
                                                           const sim::DriveSetup& setup);

}  // namespace offnominal::desk
