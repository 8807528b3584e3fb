#pragma once

#include <algorithm>
#include <offnominal/control/computed_torque.hpp>
#include <offnominal/finite.hpp>
#include <offnominal/status.hpp>

// The same motion, slower: the time of a reference falls behind the clock's. Along its path nothing
// changes; its velocity becomes s dq, its acceleration s^2 ddq + s' dq, where s is the share of its
// pace that is left. s falls from 1 along a polynomial of third order, so that s' is continuous and
// a torque that follows the acceleration does not jump.

namespace offnominal {

template <typename Scalar>
struct SlowDownConfig {
  Scalar to = Scalar(0.25);  // share of its pace that is left, 0 <= to < 1; 0: it comes to a stand
  Scalar within_s = 1;       // from pace 1 on, > 0
};

template <typename Scalar>
[[nodiscard]] Status validate(const SlowDownConfig<Scalar>& config) {
  const bool good = is_finite(config.to) && config.to >= 0 && config.to < 1 &&
                    is_finite(config.within_s) && config.within_s > 0;
  return good ? Status::kOk : Status::kInvalidLimit;
}

// The most that the pace falls in a second, half-way down.
template <typename Scalar>
[[nodiscard]] constexpr Scalar largest_pace_rate(const SlowDownConfig<Scalar>& config) {
  return Scalar(1.5) * (1 - config.to) / config.within_s;
}

// How the time of a reference runs.
template <typename Scalar>
struct Pace {
  Scalar share = 1;     // of the reference's own, s
  Scalar rate = 0;      // s', 1/s, <= 0
  double behind_s = 0;  // how far its time is behind the clock's
};

// since_s >= 0 after the slowing began. Closed, so that ticks that are left out change nothing.
// What comes after within_s is in double precision, as it may go on for as long as a run.
template <typename Scalar>
[[nodiscard]] Pace<Scalar> pace_of(const SlowDownConfig<Scalar>& config, double since_s) {
  const Scalar lost = 1 - config.to;
  const Scalar u = std::min(static_cast<Scalar>(since_s) / config.within_s, Scalar(1));
  Pace<Scalar> pace;
  pace.share = 1 - lost * u * u * (3 - 2 * u);
  pace.rate = -6 * lost * u * (1 - u) / config.within_s;
  const Scalar on_the_way_s = lost * config.within_s * u * u * u * (1 - u / 2);
  const double after_s = std::max(since_s - static_cast<double>(config.within_s), 0.0);
  pace.behind_s = static_cast<double>(on_the_way_s) + static_cast<double>(lost) * after_s;
  return pace;
}

// Makes `reference`, which is that of the clock's time less pace.behind_s, the slowed one.
template <int N, typename Scalar>
void slow_down(const Pace<Scalar>& pace, Reference<N, Scalar>& reference) {
  reference.ddq = (pace.share * pace.share) * reference.ddq + pace.rate * reference.dq;
  reference.dq *= pace.share;
}

}  // namespace offnominal
