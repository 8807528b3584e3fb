// From frames to what the drives of a robot say, for somebody who only listens.
#pragma once

#include <cstddef>
#include <memory>
#include <offnominal/hal/bus/frame.hpp>
#include <offnominal/hal/drive_protocol.hpp>
#include <offnominal/joint_count.hpp>

#include "drives/drive_port.hpp"
#include "drives/drive_settings.hpp"

namespace offnominal::desk {

/// Readings are put together as a controller does it, whatever the drives' protocol. They are
/// complete when every joint has been read since those before; they are handed over with the first
/// reading behind them, so that the torques that belong to them have come whatever their order.
class BusReadings {
 public:
  using Feedback = PerJoint<kRuntimeJoints, hal::JointFeedback>;

  BusReadings(const DriveSettings& settings, std::size_t joints, const hal::DriveLink& link);

  /// The next frame; the readings before it, where it begins others. Valid until the next call.
  const Feedback* take(const hal::ReceivedFrame& received);
  /// Those that wait when no frame comes any more; null: none.
  [[nodiscard]] const Feedback* last() const { return waits_ ? &complete_ : nullptr; }

  /// Whether the last frame was of the robot's drives, or told of them.
  [[nodiscard]] bool understood() const { return understood_; }
  [[nodiscard]] hal::DriveCounts counts() const { return drives_->counts(); }
  [[nodiscard]] hal::JointFeedback feedback(std::size_t joint, hal::Microseconds now_us) const {
    return drives_->feedback(joint, now_us);
  }

 private:
  [[nodiscard]] bool is_complete() const;
  [[nodiscard]] bool is_next() const;

  std::size_t joints_;
  std::unique_ptr<DrivePort> drives_;
  PerJoint<kRuntimeJoints, hal::Microseconds> used_us_;
  Feedback now_;
  Feedback complete_;  // that wait
  Feedback handed_;
  bool waits_ = false;
  bool understood_ = false;
};

}  // namespace offnominal::desk
