#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <offnominal/diagnosis/isolation_state.hpp>
#include <offnominal/hal/messages.hpp>
#include <offnominal/monitor.hpp>

namespace offnominal::controller {

// What the bus is told of a tick's output. judges: the monitor has had that tick; otherwise it is
// what was latched before, alone.
template <int N, typename Scalar>
[[nodiscard]] hal::Diagnosis diagnosis_of(const MonitorOutput<N, Scalar, TorqueSpace>& output,
                                          bool judges) {
  hal::Diagnosis diagnosis;
  const JointDetectors<N, Scalar>& detector = output.detector;
  if (detector.latched) {
    diagnosis.first_joint = static_cast<std::uint8_t>(detector.first_joint + 1);
    diagnosis.acts = detector.acts;
  }
  if (!judges) return diagnosis;
  diagnosis.level = detector.level;
  diagnosis.worst_joint = static_cast<std::uint8_t>(output.worst_joint + 1);
  const Scalar error = output.error_norm;
  const Scalar threshold = output.threshold;
  constexpr auto kMost = Scalar(1e6);  // more than a frame says
  if (error > 0) {
    diagnosis.error_to_threshold =
        static_cast<float>(threshold > 0 ? std::min(error / threshold, kMost) : kMost);
  }
  return diagnosis;
}

// What the bus is told of an answer.
template <typename Scalar>
[[nodiscard]] hal::FaultReport fault_report_of(const FaultDiagnosis<Scalar>& found) {
  return {static_cast<std::uint8_t>(found.kind), static_cast<std::uint8_t>(found.joint + 1),
          found.decided, static_cast<float>(found.confidence), static_cast<float>(found.size)};
}

}  // namespace offnominal::controller
