#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <offnominal/exponential.hpp>
#include <offnominal/finite.hpp>
#include <offnominal/status.hpp>

// Velocity from positions alone, for encoders that send no velocity: a tracking loop of second
// order with both poles at the bandwidth (R. D. Lorenz, K. W. Van Patten, High-resolution velocity
// estimation for all-digital, AC servo drives, 1991, without its torque feed-forward).

namespace offnominal {

template <typename Scalar>
struct VelocityObserverConfig {
  Scalar bandwidth_rad_s = 200;  // of both poles, > 0
  Scalar period_s = Scalar(0.001);
};

template <typename Scalar>
struct VelocityObserverState {
  std::uint32_t updates = 0;  // since it started; 0: it has not. Stays at the largest number.
  Scalar position{};          // rad or m
  Scalar velocity{};          // rad/s or m/s
};

// With poles at a fifth of the sampling rate: it has forgotten its start within some fifty ticks,
// and goes on behind five that had no position.
template <typename Scalar>
[[nodiscard]] VelocityObserverConfig<Scalar> velocity_observer_config(Scalar period_s) {
  return {Scalar(0.2) / period_s, period_s};
}

// kInvalidPeriod, or kInvalidFilterPole where the loop would be slower than it samples: bandwidth
// times period has to stay below 0.5.
template <typename Scalar>
[[nodiscard]] Status validate(const VelocityObserverConfig<Scalar>& config) {
  if (!is_finite(config.period_s) || config.period_s <= 0) return Status::kInvalidPeriod;
  const Scalar share = config.bandwidth_rad_s * config.period_s;
  return is_finite(share) && share > 0 && share < Scalar(0.5) ? Status::kOk
                                                              : Status::kInvalidFilterPole;
}

// Whether the velocity may be used: of the error that it started with, the speed of a joint that
// was taken to be at rest, a thousandth is left.
template <typename Scalar>
[[nodiscard]] bool is_settled(const VelocityObserverConfig<Scalar>& config,
                              const VelocityObserverState<Scalar>& state) {
  constexpr Scalar kTimes = Scalar(9.25);  // (1 + x) exp(-x) = 0.001 at x = 9.23
  return static_cast<Scalar>(state.updates) * config.bandwidth_rad_s * config.period_s > kTimes;
}

// One tick: the position measured at its end, rad or m, after `missed` ticks without one. Over
// these the position goes on at the velocity that is known, for 1/bandwidth at most: after a longer
// gap nothing is known any more. The first call, and the one after such a gap, starts at rest there
// and has to settle. kNonFinitePosition for a position that is not a number, kNumericOverflow for
// one so far away that the velocity would not be; the state is then unchanged.
template <typename Scalar>
[[nodiscard]] Status update(const VelocityObserverConfig<Scalar>& config, Scalar position,
                            VelocityObserverState<Scalar>& state, std::uint32_t missed = 0) {
  if (!is_finite(position)) return Status::kNonFinitePosition;
  const Scalar share = config.bandwidth_rad_s * config.period_s;
  if (state.updates == 0 || static_cast<Scalar>(missed) * share > Scalar(1)) {
    state = {1, position, Scalar(0)};
    return Status::kOk;
  }
  // Poles of the sampled loop at exp(-bandwidth period), both.
  const Scalar pole = exponential(-share);
  const Scalar predicted =
      state.position + static_cast<Scalar>(missed + 1) * config.period_s * state.velocity;
  const Scalar innovation = position - predicted;
  const Scalar velocity =
      state.velocity + (Scalar(1) - pole) * (Scalar(1) - pole) / config.period_s * innovation;
  if (!is_finite(velocity)) return Status::kNumericOverflow;
  state.position = predicted + (Scalar(1) - pole * pole) * innovation;
  state.velocity = velocity;
  if (state.updates < std::numeric_limits<std::uint32_t>::max()) ++state.updates;
  return Status::kOk;
}

// Largest error of the velocity that the observer can make once it has settled, rad/s or m/s, on a
// motion whose acceleration stays within +-max_acceleration (rad/s^2 or m/s^2) and positions that
// are off by at most position_error (half a count): the sums of the magnitudes of its impulse
// responses. What a bound's velocity_error has to hold.
template <typename Scalar>
[[nodiscard]] Scalar velocity_error_bound(const VelocityObserverConfig<Scalar>& config,
                                          Scalar max_acceleration, Scalar position_error) {
  const Scalar period = config.period_s;
  const Scalar pole = exponential(-config.bandwidth_rad_s * period);
  const Scalar position_gain = Scalar(1) - pole * pole;
  const Scalar velocity_gain = (Scalar(1) - pole) * (Scalar(1) - pole) / period;
  // Error of position and velocity, a = true - estimated, one tick after the other:
  //   predicted p = a_p + T a_v + T^2/2 acc;  innovation = p + n;  a_p' = p - g_p i;
  //   a_v' = a_v + T acc - g_v i.
  const auto response = [&](Scalar acceleration, Scalar noise) {
    constexpr int kMostTicks = 1 << 20;
    constexpr Scalar kSettled = Scalar(1e-7);
    Scalar sum = 0;
    Scalar error_p = 0;
    Scalar error_v = 0;
    for (int tick = 0; tick < kMostTicks; ++tick) {
      const Scalar now = tick == 0 ? Scalar(1) : Scalar(0);
      const Scalar predicted =
          error_p + period * error_v + period * period / Scalar(2) * acceleration * now;
      const Scalar innovation = predicted + noise * now;
      error_p = predicted - position_gain * innovation;
      error_v += period * acceleration * now - velocity_gain * innovation;
      sum += std::fabs(error_v);
      if (std::fabs(error_v) + std::fabs(error_p) / period < kSettled * sum) break;
    }
    return sum;
  };
  return max_acceleration * response(Scalar(1), Scalar(0)) +
         position_error * response(Scalar(0), Scalar(1));
}

}  // namespace offnominal
