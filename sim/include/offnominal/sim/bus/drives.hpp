// The drives' end of the bus, whatever they speak.
#pragma once

#include <cstddef>
#include <cstdint>
#include <offnominal/hal/drive_description.hpp>
#include <offnominal/hal/drive_protocol.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>

#include "offnominal/sim/joint_state.hpp"

namespace offnominal::sim {

/// What a robot file does not say of emulated drives.
struct DriveSetup {
  std::size_t joints = 1;  ///< 1 to kMaxJoints
  hal::DriveLink link{};
  double max_torque_nm = 1000.0;  ///< N on a joint that slides
};

/// Drives of one protocol, one a joint. A new one is a class of this face beside the protocol's
/// driver in hal.
class Drives {
 public:
  using Reading = std::optional<hal::EncoderReading>;
  /// Of one tick, from the drives.
  static constexpr std::size_t kMostFrames = 3 * static_cast<std::size_t>(kMaxJoints);

  virtual ~Drives() = default;

  [[nodiscard]] virtual std::size_t joints() const = 0;

  /// Takes a frame from the bus; whether it was a valid command for one of these drives, or for
  /// several.
  virtual bool take(const hal::ReceivedFrame& received) = 0;

  /// Time has gone on: watch-dogs, states. To be called every tick, after what has come is taken.
  virtual void tick(hal::Microseconds now_us) = 0;

  [[nodiscard]] virtual hal::DriveMode mode(std::size_t joint) const = 0;
  /// Torque at the joint's speed (rad/s), N m, as it is really given.
  [[nodiscard]] virtual double torque_nm(std::size_t joint, double speed_rad_s) const = 0;
  /// Valid commands since the start; wraps.
  [[nodiscard]] virtual std::uint32_t commands(std::size_t joint) const = 0;

  /// The frames of one tick, at most kMostFrames; `readings` and `applied_nm` have one entry a
  /// joint. A joint without a reading has an encoder that has failed.
  virtual std::size_t frames(std::span<const Reading> readings, std::span<const double> applied_nm,
                             std::span<hal::Frame> into) = 0;

  /// Of commands.
  [[nodiscard]] virtual hal::DriveCounts counts() const = 0;

  /// Whether a frame is from a joint's drive, or for it, for faults of the bus; one that carries
  /// several joints is of each of them.
  [[nodiscard]] virtual bool concerns(const hal::Frame& frame, std::size_t joint) const = 0;
  /// Identifiers of classic frames of 8 bytes that somebody forges: a joint's reading, a torque
  /// command to it.
  [[nodiscard]] virtual std::uint32_t reading_id(std::size_t joint) const = 0;
  [[nodiscard]] virtual std::uint32_t command_id(std::size_t joint) const = 0;

  [[nodiscard]] bool all_in_torque_mode() const {
    for (std::size_t j = 0; j < joints(); ++j) {
      if (mode(j) != hal::DriveMode::kTorque) return false;
    }
    return true;
  }
  [[nodiscard]] bool any_in_torque_mode() const {
    for (std::size_t j = 0; j < joints(); ++j) {
      if (mode(j) == hal::DriveMode::kTorque) return true;
    }
    return false;
  }
};

/// Throws std::invalid_argument for fewer or more joints than there may be.
inline std::size_t checked_joints(std::size_t joints) {
  constexpr auto kMost = static_cast<std::size_t>(kMaxJoints);
  if (joints >= 1 && joints <= kMost) return joints;
  throw std::invalid_argument("drives: found " + std::to_string(joints) +
                              " joints, allowed is 1 to " + std::to_string(kMost));
}

}  // namespace offnominal::sim
