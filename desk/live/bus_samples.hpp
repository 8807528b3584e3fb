#pragma once

#include <cstddef>
#include <cstdint>
#include <offnominal/controller/sample_taker.hpp>
#include <offnominal/hal/bus/frame.hpp>
#include <offnominal/hal/messages.hpp>
#include <optional>
#include <string>
#include <vector>

#include "drives/bus_readings.hpp"
#include "drives/drive_table.hpp"
#include "replay/watch.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk::live {

/// A sample of every joint, as the controller had it.
struct BusSample {
  Watch::Sample sample;
  hal::Microseconds time_us = 0;  // of its newest reading
  std::uint32_t missing = 0;      // ticks before it that had none
  bool driven =
      false;  // every drive says that it gives the torque it is told: else brakes may hold
};

/// From the frames on a bus to samples, for somebody who only listens: readings (bus_readings.hpp)
/// that the controller would have used.
class BusSamples {
 public:
  /// Of a robot whose period_s is that of the readings, and with a bound, whatever it is.
  explicit BusSamples(const RobotDescription& robot);

  /// The next frame; the sample before it, where it begins another one. Valid until the next call.
  const BusSample* take(const hal::ReceivedFrame& received);

  /// The controller's last word on itself; none before the first, and where its drives' protocol
  /// has none.
  [[nodiscard]] const std::optional<hal::Heartbeat>& heartbeat() const { return heartbeat_; }
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  [[nodiscard]] std::uint64_t understood() const { return understood_; }
  [[nodiscard]] hal::DriveCounts counts() const { return readings_.counts(); }
  /// From 0, the joints that have no valid reading at that time.
  [[nodiscard]] std::vector<std::size_t> silent_joints(hal::Microseconds now_us) const;

 private:
  using Taker = controller::SampleTaker<kRuntimeJoints, double>;

  bool hand_over(const Taker::Feedback& readings);

  std::size_t joints_;
  hal::Microseconds period_us_;
  const DriveProtocol& protocol_;
  BusReadings readings_;
  Taker taker_;
  Taker::Data data_;
  std::optional<hal::Microseconds> last_us_;  // of the sample before
  BusSample sample_;
  std::optional<hal::Heartbeat> heartbeat_;
  std::uint64_t frames_ = 0;
  std::uint64_t understood_ = 0;
};

}  // namespace offnominal::desk::live
