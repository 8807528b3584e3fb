// What the encoders of the arm send, with the faults that they have.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <offnominal/hal/messages.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "offnominal/sim/bus/fault_event.hpp"
#include "offnominal/sim/encoder.hpp"

namespace offnominal::sim {

class JointSensors {
 public:
  using Readings = std::array<std::optional<hal::EncoderReading>, 2>;

  /// Throws as Encoders. Events that are no encoder's are ignored.
  JointSensors(const EncoderConfig& config, std::vector<FaultEvent> faults)
      : encoders_(config), faults_(std::move(faults)) {}

  /// At time_s of the run, period_s after the last reading. None where an encoder has dropped out.
  Readings read(const JointState& truth, double time_s, double period_s, bool with_velocity) {
    JointState measured = encoders_.measure(truth, period_s);
    std::array<bool, 2> out{};
    for (const FaultEvent& fault : faults_) {
      if (fault.joint < 0 || fault.joint > 1 || !fault.is_active(time_s)) continue;
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
    Readings readings;
    for (std::size_t j = 0; j < readings.size(); ++j) {
      const auto i = static_cast<Eigen::Index>(j);
      if (out[j]) continue;
      readings[j] = hal::EncoderReading{static_cast<float>(measured.q[i]),
                                        with_velocity ? static_cast<float>(measured.dq[i]) : 0.0F,
                                        with_velocity};
      last_[j] = readings[j];
    }
    return readings;
  }

 private:
  Encoders encoders_;
  std::vector<FaultEvent> faults_;
  Readings last_;
};

}  // namespace offnominal::sim
