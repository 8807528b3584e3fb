#pragma once

#include <cstdint>

namespace offnominal {

// Whether the robot still behaves as its model says. `level` follows |e| > mu from tick to tick;
// `latched` keeps the first crossing until clear_latch().
template <typename Scalar>
struct DetectorState {
  bool level = false;
  bool latched = false;
  std::uint64_t detection_tick = 0;  // of the first crossing, from reset(); valid while latched
  double detection_time_s = 0;       // the same in seconds
};

// Judges one tick. error_norm = |e| >= 0 and mu >= 0 in rad/s or m/s. At |e| = mu, and so at
// |e| = mu = 0, there is no detection.
template <typename Scalar>
inline void update(DetectorState<Scalar>& state, Scalar error_norm, Scalar mu, std::uint64_t tick,
                   double time_s) {
  state.level = error_norm > mu;
  if (state.level && !state.latched) {
    state.latched = true;
    state.detection_tick = tick;
    state.detection_time_s = time_s;
  }
}

// Forgets the latched detection. The next crossing latches again, with its own time.
template <typename Scalar>
inline void clear_latch(DetectorState<Scalar>& state) {
  state.latched = false;
  state.detection_tick = 0;
  state.detection_time_s = 0;
}

}  // namespace offnominal
