// What a blind benchmark asks the simulator for: which physical effect is hidden in the robot, what
// is wrong with its log, how it moves. Everything else is drawn from the seed.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "offnominal/sim/hidden/effect_table.hpp"

namespace offnominal::sim::hidden {

/// What is wrong with the log. The robot moves the same; every log of this robot has the fault.
enum class DataFault {
  kNone,
  kDegrees,            ///< positions in degrees
  kSwappedTorqueSign,  ///< torque of one joint or of both with the wrong sign
  kStaleSamples,  ///< 2 to 5 % of the rows repeat the last good value of positions, torques or all
  kClockSkew,     ///< torques 15 to 40 ms late against the positions, or a clock 0.15 to 0.3 % off
};

enum class Excitation {
  kRich,  ///< both joints, 0.1 to 1.5 Hz, about +-1 rad, fast and slow phases
  kPoor,  ///< one slow small sinusoid, or one speed to and fro, or a tiny range
};

struct Request {
  std::uint64_t seed = 0;
  std::vector<HiddenEffect> effects;  ///< each at most once; may be empty
  OutsideEffect outside = OutsideEffect::kNone;
  DataFault fault = DataFault::kNone;
  Excitation excitation = Excitation::kRich;
  double effect_size = 1.0;  ///< factor on the drawn size of effects and outside effect, > 0
  double torque_noise_share = 0.002;  ///< standard deviation as a share of the torque limit, >= 0
  int encoder_bits = 19;              ///< counts per turn of the joint 2^bits, 1 to 32
  double duration_s = 30.0;           ///< of the recording, > 0
  double sample_rate_hz = 1000.0;     ///< of drive and log, 100 to 10000
};

/// Throws std::invalid_argument naming the field, what was found and what is allowed.
void validate(const Request& request);

std::string_view name(DataFault fault);

}  // namespace offnominal::sim::hidden
