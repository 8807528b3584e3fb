// The other end of the bus: a plant, its drives and its encoders.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <offnominal/hal/bus/bus.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "offnominal/sim/bus/drives.hpp"
#include "offnominal/sim/bus/joint_sensors.hpp"
#include "offnominal/sim/plant.hpp"

namespace offnominal::sim {

struct PlantNodeConfig {
  double period_s = 0.001;
  EncoderConfig encoders{};
  bool sends_velocity = true;
  /// Faults of drives and encoders, and pushes; others have no effect here.
  std::vector<FaultEvent> faults{};
  std::vector<bool> turns_on{};  ///< as JointSensors
};

/// A plant behind one drive a joint. Until every drive is first in torque mode, brakes hold the
/// joints at their start and their time stands at 0; they do not close again.
class PlantNode {
 public:
  /// Throws std::invalid_argument without a plant, without a drive for each of its joints, and for
  /// a fault on a joint that it has not.
  PlantNode(std::unique_ptr<Plant> plant, std::unique_ptr<Drives> drives,
            const PlantNodeConfig& config)
      : plant_(checked(std::move(plant), config)),
        config_(config),
        drives_(checked(std::move(drives), *plant_)),
        sensors_(config.encoders, config.faults, config.turns_on),
        applied_(JointVector::Zero(plant_->joint_count())),
        acting_(applied_) {}

  /// One tick: obeys what has come, moves on by one period, sends what is measured. A frame that
  /// does not go out until `deadline_us` never does.
  template <hal::Bus Bus>
  void tick(hal::Microseconds deadline_us, Bus& bus) {
    receive(bus);
    drives_->tick(bus.now());
    move();
    publish(deadline_us, bus);
  }

  /// So many periods in which it neither heard nor measured: the joints go on under the torques
  /// that they have.
  void miss(std::uint32_t periods) {
    for (; periods > 0; --periods) move();
  }

  /// Takes the frames that have come without moving on; returns whether every drive has had a valid
  /// command since the last move.
  template <hal::Bus Bus>
  bool receive(Bus& bus) {
    std::array<hal::ReceivedFrame, 16> frames;
    for (std::size_t count = bus.receive(frames); count > 0; count = bus.receive(frames)) {
      for (std::size_t i = 0; i < count; ++i) drives_->take(frames[i]);
      if (count < frames.size()) break;
    }
    for (std::size_t j = 0; j < drives_->joints(); ++j) {
      if (drives_->commands(j) == accepted_at_move_[j]) return false;
    }
    return true;
  }

  /// From now on it has these faults and no others, with their times on time_s(). False, and
  /// nothing changed, where the plant cannot change its own. Throws std::invalid_argument for a
  /// joint that it has not.
  [[nodiscard]] bool set_faults(const std::vector<FaultEvent>& faults) {
    check(faults, *plant_);
    if (!plant_->set_faults(faults)) return false;
    config_.faults = faults;
    sensors_.set_faults(faults);
    return true;
  }

  [[nodiscard]] const JointState& state() const { return plant_->state(); }
  /// Per joint, N m or N, as the drives have it, and say it.
  [[nodiscard]] const JointVector& applied_nm() const { return applied_; }
  /// That really acted on the joints over the last move: less where a drive loses some, with what
  /// pushes them.
  [[nodiscard]] const JointVector& acting_nm() const { return acting_; }
  [[nodiscard]] const Drives& drives() const { return *drives_; }
  [[nodiscard]] const Plant& plant() const { return *plant_; }
  [[nodiscard]] bool started() const { return started_; }
  /// Of the plant, since the brakes opened.
  [[nodiscard]] double time_s() const { return static_cast<double>(moves_) * config_.period_s; }

 private:
  static std::unique_ptr<Plant> checked(std::unique_ptr<Plant> plant,
                                        const PlantNodeConfig& config) {
    if (!plant) throw std::invalid_argument("plant node: no plant");
    check(config.faults, *plant);
    return plant;
  }
  static void check(const std::vector<FaultEvent>& faults, const Plant& plant) {
    for (const FaultEvent& fault : faults) {
      if (fault.joint < plant.joint_count()) continue;
      throw std::invalid_argument(std::string(info_of(fault.kind).name) + ": found joint " +
                                  std::to_string(fault.joint + 1) + ", allowed is 1 to " +
                                  std::to_string(plant.joint_count()));
    }
  }
  static std::unique_ptr<Drives> checked(std::unique_ptr<Drives> drives, const Plant& plant) {
    const auto joints = static_cast<std::size_t>(plant.joint_count());
    if (drives && drives->joints() == joints) return drives;
    throw std::invalid_argument("plant node: found " +
                                std::to_string(drives ? drives->joints() : 0) +
                                " drives, allowed is " + std::to_string(joints));
  }

  void move() {
    for (std::size_t j = 0; j < drives_->joints(); ++j) {
      const auto i = static_cast<Eigen::Index>(j);
      accepted_at_move_[j] = drives_->commands(j);
      applied_[i] = drives_->torque_nm(j, state().dq[i]);
    }
    started_ = started_ || drives_->all_in_torque_mode();
    if (!started_) return;
    acting_ = applied_;
    for (const FaultEvent& fault : config_.faults) {
      if (!fault.is_active(time_s())) continue;
      // The drive does not know: its status says what it means to give.
      if (fault.kind == FaultEventKind::kTorqueLoss) acting_[fault.joint] *= 1.0 - fault.size;
    }
    for (const FaultEvent& fault : config_.faults) {
      const bool pushes = fault.kind == FaultEventKind::kDisturbanceTorque;
      if (pushes && fault.is_active(time_s())) acting_[fault.joint] += fault.size;
    }
    plant_->step(time_s(), acting_, config_.period_s);
    ++moves_;
  }

  template <hal::Bus Bus>
  void publish(hal::Microseconds deadline_us, Bus& bus) {
    const auto readings =
        sensors_.read(state(), time_s(), config_.period_s, config_.sends_velocity);
    std::array<hal::Frame, Drives::kMostFrames> frames;
    const std::span<const double> applied(applied_.data(), readings.size());
    const std::size_t count = drives_->frames(readings, applied, frames);
    for (std::size_t i = 0; i < count; ++i) {
      // What does not go out is seen by its absence, at the other end.
      static_cast<void>(bus.send(frames[i], deadline_us));
    }
  }

  std::unique_ptr<Plant> plant_;
  PlantNodeConfig config_;
  std::unique_ptr<Drives> drives_;
  JointSensors sensors_;
  JointVector applied_;
  JointVector acting_;
  std::array<std::uint32_t, static_cast<std::size_t>(kMaxJoints)> accepted_at_move_{};
  std::int64_t moves_ = 0;
  bool started_ = false;
};

}  // namespace offnominal::sim
