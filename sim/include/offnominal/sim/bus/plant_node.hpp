// The other end of the bus: arm, drives and encoders.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <offnominal/hal/bus.hpp>
#include <vector>

#include "offnominal/sim/bus/joint_drives.hpp"
#include "offnominal/sim/bus/joint_sensors.hpp"
#include "offnominal/sim/two_link_plant.hpp"

namespace offnominal::sim {

struct PlantNodeConfig {
  double period_s = 0.001;
  int substeps = 1;  ///< Runge-Kutta steps of the plant in one tick
  EncoderConfig encoders{};
  DriveConfig drives{};
  hal::FrameFormat format = hal::FrameFormat::kClassic;
  bool sends_velocity = true;
  /// Faults of drives and encoders; others have no effect here.
  std::vector<FaultEvent> faults{};
};

/// The paper's arm behind two drives. Until every drive is first in torque mode, brakes hold the
/// arm at its start and its time stands at 0; they do not close again.
class PlantNode {
 public:
  static constexpr std::size_t kJoints = 2;
  using Applied = std::array<double, kJoints>;

  PlantNode(const TwoLinkPlant& plant, const JointState& start, const PlantNodeConfig& config)
      : plant_(plant),
        config_(config),
        drives_(config.drives, config.format),
        sensors_(config.encoders, config.faults),
        state_(start) {}

  /// One tick: obeys what has come, moves on by one period, sends what is measured. A frame that
  /// does not go out until `deadline_us` never does.
  template <hal::Bus Bus>
  void tick(hal::Microseconds deadline_us, Bus& bus) {
    receive(bus);
    drives_.check_age(bus.now());
    move();
    publish(deadline_us, bus);
  }

  /// So many periods in which it neither heard nor measured: the arm goes on under the torques that
  /// it has.
  void miss(std::uint32_t periods) {
    for (; periods > 0; --periods) move();
  }

  /// Takes the frames that have come without moving on; returns whether every drive has had a valid
  /// command since the last move.
  template <hal::Bus Bus>
  bool receive(Bus& bus) {
    std::array<hal::ReceivedFrame, 16> frames;
    for (std::size_t count = bus.receive(frames); count > 0; count = bus.receive(frames)) {
      for (std::size_t i = 0; i < count; ++i) drives_.take(frames[i]);
      if (count < frames.size()) break;
    }
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (drives_.source(j).accepted == accepted_at_move_[j]) return false;
    }
    return true;
  }

  [[nodiscard]] const JointState& state() const { return state_; }
  /// As the drives have it, and say it.
  [[nodiscard]] const Applied& applied_nm() const { return applied_; }
  /// That really acted on the joints over the last move: less where a drive loses some.
  [[nodiscard]] const Eigen::Vector2d& acting_nm() const { return acting_; }
  [[nodiscard]] const JointDrives<kJoints>& drives() const { return drives_; }
  [[nodiscard]] const TwoLinkPlant& plant() const { return plant_; }
  [[nodiscard]] bool started() const { return started_; }
  /// Of the arm, since the brakes opened.
  [[nodiscard]] double time_s() const { return static_cast<double>(moves_) * config_.period_s; }

 private:
  void move() {
    for (std::size_t j = 0; j < kJoints; ++j) {
      accepted_at_move_[j] = drives_.source(j).accepted;
      applied_[j] = drives_.torque_nm(j, state_.dq[static_cast<Eigen::Index>(j)]);
    }
    started_ = started_ || drives_.all_in_torque_mode();
    if (!started_) return;
    acting_ = {applied_[0], applied_[1]};
    for (const FaultEvent& fault : config_.faults) {
      const bool lost = fault.kind == FaultEventKind::kTorqueLoss && fault.is_active(time_s());
      // The drive does not know: its status says what it means to give.
      if (lost) acting_[fault.joint] *= 1.0 - fault.size;
    }
    state_ = plant_.step(time_s(), state_, acting_, config_.period_s, config_.substeps);
    ++moves_;
  }

  template <hal::Bus Bus>
  void publish(hal::Microseconds deadline_us, Bus& bus) {
    const auto readings = sensors_.read(state_, time_s(), config_.period_s, config_.sends_velocity);
    std::array<hal::Frame, 2 * kJoints> frames;
    const std::size_t count = drives_.frames(readings, applied_, frames);
    for (std::size_t i = 0; i < count; ++i) {
      // What does not go out is seen by its absence, at the other end.
      static_cast<void>(bus.send(frames[i], deadline_us));
    }
  }

  TwoLinkPlant plant_;
  PlantNodeConfig config_;
  JointDrives<kJoints> drives_;
  JointSensors sensors_;
  JointState state_;
  Applied applied_{};
  Eigen::Vector2d acting_ = Eigen::Vector2d::Zero();
  std::array<std::uint32_t, kJoints> accepted_at_move_{};
  std::int64_t moves_ = 0;
  bool started_ = false;
};

}  // namespace offnominal::sim
