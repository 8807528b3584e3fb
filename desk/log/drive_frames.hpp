#pragma once

#include <cstddef>
#include <optional>

#include "drives/drive_settings.hpp"
#include "log/named_columns.hpp"
#include "log/recording_file.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

/// The drives on a robot's bus.
struct RobotBus {
  DriveSettings drives;
  std::size_t joints = 0;
  double period_s = 0;  // of the readings
};

/// Of a robot whose drives speak a protocol that offnominal's own DBC file does not have.
[[nodiscard]] std::optional<RobotBus> bus_of(const RobotDescription& robot);

/// A `candump -l` log of such drives as t, q1.., dq1.., tau1..: a row for every time that each
/// joint was read anew while its drive said what torque it gives, as the controller would have had
/// it. Where drives do not say that, it is the torque that they were told; rows of before any was,
/// and that a gap parts from the rest, are left out. Throws InputError for a line of another form,
/// for frames of the drives on two interfaces, times that go back, and where a joint is never read.
[[nodiscard]] NamedColumns read_drive_frames(RecordingFile& file, const RobotBus& bus);

}  // namespace offnominal::desk
