#pragma once

#include <cstdint>
#include <offnominal/diagnosis/fault_kind.hpp>
#include <optional>
#include <string>
#include <vector>

#include "arm_effects.hpp"
#include "arm_rig.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

// The seven-joint arm in MuJoCo with a fault from some time on, and what its owner knows of it.

namespace offnominal::bench {

// What an encoder does wrong. The drive's own loop closes over another one: the arm moves on.
struct EncoderFault {
  int joint = 0;               // from 0
  std::optional<double> jump;  // rad; none: it sticks
};

// A fault that begins at kFaultS: an effect, a push, or an encoder.
struct DetectionFault {
  std::string words;
  std::optional<ArmEffect> effect;
  std::optional<ArmPush> push;
  std::optional<EncoderFault> encoder;
  std::optional<int> joint;  // from 0, that it acts on alone
  FaultKind kind = FaultKind::kUnknown;
  std::optional<double> size;  // as the kind says it
};

inline constexpr double kFaultS = 6;
inline constexpr double kFaultRunS = 10;

// The faults of the table in docs/calibrate.md.
[[nodiscard]] std::vector<DetectionFault> detection_faults();

// Those, and others that only isolation is asked for: docs/diagnosis.md.
[[nodiscard]] std::vector<DetectionFault> isolation_faults();

// The arm as its file says it: CAD off by 3 %, friction by 10 %; no limits, no bound.
[[nodiscard]] desk::RobotDescription owners_robot(std::uint64_t seed);

// One run of the arm, at 1 kHz, positions of 19 bits and no velocity, torque noise of 0.2 % of each
// joint's largest. Each `run` moves otherwise. The recording is written into `folder` and read back
// as a user's is.
[[nodiscard]] desk::Log arm_recording(std::uint64_t run, double duration_s,
                                      const DetectionFault* fault, const std::string& folder);

}  // namespace offnominal::bench
