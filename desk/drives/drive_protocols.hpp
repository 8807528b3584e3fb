// The list of drive protocols. Heavy: who does not compile something for each of them includes
// drive_table.hpp.
#pragma once

#include <offnominal/hal/protocols/can_simple/can_simple.hpp>
#include <offnominal/hal/protocols/protected/protected_drives.hpp>
#include <tuple>

#include "offnominal/sim/bus/joint_drives.hpp"
#include "offnominal/sim/bus/odrive_drives.hpp"

namespace offnominal::desk {

/// What describes a protocol (offnominal/hal/drive_description.hpp) and has its driver, and the
/// drives that speak it in the simulator.
template <typename Description, typename Emulation>
struct DriveRow {
  using Protocol = Description;
  using Emulated = Emulation;
};

/// A new protocol is a row here. The first is that of robot files without [drives].
using DriveProtocols = std::tuple<DriveRow<hal::Protected, sim::JointDrives>,
                                  DriveRow<hal::CanSimple, sim::OdriveDrives>>;

}  // namespace offnominal::desk
