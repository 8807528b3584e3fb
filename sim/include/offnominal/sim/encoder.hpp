// Joint encoders: what a controller is given instead of the true state.
#pragma once

#include "offnominal/sim/joint_state.hpp"

namespace offnominal::sim {

enum class VelocitySource {
  kIdeal,               ///< the true velocity
  kQuantised,           ///< the true velocity, rounded to velocity_step_rad_s
  kBackwardDifference,  ///< measured positions of this and the last sample over the period
};

struct EncoderConfig {
  int bits_per_turn = 0;  ///< position rounded to 2 pi / 2^bits, 1 to 52; 0 is an ideal sensor
  VelocitySource velocity = VelocitySource::kIdeal;
  double velocity_step_rad_s = 0.0;  ///< > 0 where velocity is quantised, else ignored
};

/// Nearest multiple of step; value itself where step is 0. The error is at most step / 2.
double quantise(double value, double step);

/// Size of one count, rad; 0 for an ideal sensor.
double position_step_rad(const EncoderConfig& config);

/// One encoder per joint. It keeps the last measured position for the backward difference.
class Encoders {
 public:
  /// Throws std::invalid_argument naming the field, what was found and what is allowed.
  explicit Encoders(const EncoderConfig& config);

  /// Measured state of as many joints as ever, period_s > 0 after the last sample. The first
  /// backward difference has no predecessor and gives the true velocity, rounded to one count per
  /// period.
  JointState measure(const JointState& truth, double period_s);

 private:
  EncoderConfig config_;
  JointVector last_q_;  // empty before the first sample
};

}  // namespace offnominal::sim
