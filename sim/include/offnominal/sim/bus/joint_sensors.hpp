// What the encoders of the joints send, with the faults that they have.
#pragma once

#include <array>
#include <cstddef>
#include <offnominal/hal/messages.hpp>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "offnominal/sim/bus/fault_event.hpp"
#include "offnominal/sim/encoder.hpp"

namespace offnominal::sim {

class JointSensors {
 public:
  using Reading = std::optional<hal::EncoderReading>;

  /// Throws as Encoders. Events that are no encoder's, or of a joint that is not there, are
  /// ignored. turns_on: per joint, whether it may turn on and on, so that its frames carry its
  /// position modulo ten turns (hal::carried_position()); of joints that it does not name none
  /// does.
  JointSensors(const EncoderConfig& config, std::vector<FaultEvent> faults,
               std::vector<bool> turns_on)
      : encoders_(config), faults_(std::move(faults)), turns_on_(std::move(turns_on)) {}

  /// From now on these and no others.
  void set_faults(std::vector<FaultEvent> faults) { faults_ = std::move(faults); }

  /// At time_s of the run, period_s after the last reading: one entry a joint, until the next call.
  /// None where an encoder has dropped out.
  std::span<const Reading> read(const JointState& truth, double time_s, double period_s,
                                bool with_velocity) {
    JointState measured = encoders_.measure(truth, period_s);
    std::array<bool, static_cast<std::size_t>(kMaxJoints)> out{};
    for (const FaultEvent& fault : faults_) {
      if (fault.joint < 0 || fault.joint >= truth.q.size() || !fault.is_active(time_s)) continue;
      const auto i = static_cast<Eigen::Index>(fault.joint);
      const auto j = static_cast<std::size_t>(fault.joint);
      if (fault.kind == FaultEventKind::kEncoderBias) measured.q[i] += fault.size;
      if (fault.kind == FaultEventKind::kEncoderDrift) {
        measured.q[i] += fault.size * (time_s - fault.begin_s);
        measured.dq[i] += fault.size;
      }
      if (fault.kind == FaultEventKind::kEncoderStuck && last_[j]) {
        measured.q[i] = static_cast<double>(last_[j]->position);
        measured.dq[i] = static_cast<double>(last_[j]->velocity);
      }
      if (fault.kind == FaultEventKind::kEncoderDropout) out[j] = true;
    }
    const auto joints = static_cast<std::size_t>(truth.q.size());
    for (std::size_t j = 0; j < joints; ++j) {
      const auto i = static_cast<Eigen::Index>(j);
      now_[j].reset();
      if (out[j]) continue;
      const bool turns_on = j < turns_on_.size() && turns_on_[j];
      now_[j] = hal::EncoderReading{
          turns_on ? hal::carried_position(measured.q[i]) : static_cast<float>(measured.q[i]),
          with_velocity ? static_cast<float>(measured.dq[i]) : 0.0F, with_velocity};
      last_[j] = now_[j];
    }
    return std::span<const Reading>(now_).first(joints);
  }

 private:
  using Readings = std::array<Reading, static_cast<std::size_t>(kMaxJoints)>;

  Encoders encoders_;
  std::vector<FaultEvent> faults_;
  std::vector<bool> turns_on_;
  Readings now_;
  Readings last_;
};

}  // namespace offnominal::sim
