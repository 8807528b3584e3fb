#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

// Positions that no joint goes through. An encoder that sticks stops within a tick; one that jumps
// is elsewhere from one tick to the next and moves on as before. Both are accelerations far beyond
// those that the joint has shown so far, read from the positions themselves: whoever gave the
// velocity may have smoothed it.

namespace offnominal {

inline constexpr std::size_t kEncoderLag = 8;  // ticks over which a stop is judged

// What is seen of one joint's positions. Plain data.
template <typename Scalar>
struct EncoderWatch {
  // Positions of the last samples, the newest at `newest`, older ones before it, round and round.
  std::array<Scalar, 2 * kEncoderLag + 1> q{};
  std::uint8_t newest = 0;
  std::uint8_t window_ticks = 0;  // since the windows of the largest were moved on
  std::uint32_t filled = 0;       // samples in a row, up to the largest number
  std::uint32_t still = 0;        // samples in a row with the same position
  bool stopped_at_once = false;   // within one tick; while `stopped`
  bool stopped = false;           // too hard for a joint; until it moves again
  bool moved = false;             // at all, since the watch began
  Scalar last_step{};             // the last that was not 0
  // Largest second difference over one tick and over the lag, and largest way over the lag: of this
  // window, of the one before, and of all before that.
  std::array<Scalar, 3> jerk{};
  std::array<Scalar, 3> stop{};
  std::array<Scalar, 3> way{};
  Scalar candidate{};                            // a step that may be a jump: the next sample tells
  Scalar jump{};                                 // the last one that was, rad or m
  std::uint32_t since_jump = ~std::uint32_t{0};  // samples
};

namespace detail {

inline constexpr std::uint32_t kEncoderWarmUp = 200;  // samples

// A second difference this many times larger than any before is no motion.
template <typename Scalar>
inline constexpr Scalar kBeyondMotion = 4;

template <typename Scalar>
[[nodiscard]] Scalar position_before(const EncoderWatch<Scalar>& watch, std::size_t ticks) {
  const std::size_t size = watch.q.size();
  return watch.q[(watch.newest + size - ticks) % size];
}

template <typename Scalar>
void widen(std::array<Scalar, 3>& largest, Scalar value) {
  largest[0] = std::max(largest[0], Eigen::numext::abs(value));
}
// `kept` < 1: so that one knock long ago does not blind it.
template <typename Scalar>
void move_on(std::array<Scalar, 3>& largest, Scalar kept) {
  largest[2] = std::max(kept * largest[2], largest[1]);
  largest[1] = largest[0];
  largest[0] = Scalar(0);
}

// Whether the newest second difference takes the candidate back: then it was a jump.
template <typename Scalar>
void judge_jump(EncoderWatch<Scalar>& watch, Scalar second, bool warm) {
  const Scalar size = Eigen::numext::abs(watch.candidate);
  if (size > 0 && Eigen::numext::abs(second + watch.candidate) < Scalar(0.3) * size) {
    watch.jump = watch.candidate;
    watch.since_jump = 0;
  }
  // Of a joint that is stopped by force too: no more than the way of a tick or two.
  const Scalar steps = 3 * watch.way[2] / static_cast<Scalar>(kEncoderLag);
  const bool beyond = warm && Eigen::numext::abs(second) >
                                  std::max(2 * kBeyondMotion<Scalar> * watch.jerk[2], steps);
  watch.candidate = beyond && watch.since_jump > 0 ? second : Scalar(0);
}

template <typename Scalar>
void judge_stop(EncoderWatch<Scalar>& watch, Scalar step, bool warm) {
  if (step != 0) {
    watch.last_step = step;
    watch.still = 0;
    watch.moved = true;
    watch.stopped = watch.stopped_at_once = false;
    return;
  }
  watch.still += watch.still < ~std::uint32_t{0} ? 1U : 0U;
  if (watch.still != kEncoderLag || !warm) return;
  const Scalar before =
      position_before(watch, kEncoderLag) - position_before(watch, 2 * kEncoderLag);
  // Out of a motion, not of what a knock does to a joint that rests.
  watch.stopped = Eigen::numext::abs(before) >
                  std::max(kBeyondMotion<Scalar> * watch.stop[2], watch.way[2] / 10);
  const Scalar mean_step = before / static_cast<Scalar>(kEncoderLag);
  watch.stopped_at_once = watch.stopped && watch.last_step / mean_step > Scalar(0.7);
}

}  // namespace detail

// Takes the next sample's position, rad or m. `gap`: samples are missing before it, and what spans
// them is not judged.
template <typename Scalar>
void look_at(EncoderWatch<Scalar>& watch, Scalar q, bool gap) {
  using detail::position_before;
  if (gap) watch.filled = 0;
  const Scalar last = watch.q[watch.newest];
  watch.newest = static_cast<std::uint8_t>((watch.newest + 1U) % watch.q.size());
  watch.q[watch.newest] = q;
  watch.filled += watch.filled < ~std::uint32_t{0} ? 1U : 0U;
  watch.since_jump += watch.since_jump < ~std::uint32_t{0} ? 1U : 0U;
  if (watch.filled < 3) return;
  const bool warm = watch.filled > detail::kEncoderWarmUp;
  const Scalar step = q - last;
  const Scalar second = step - (last - position_before(watch, 2));
  detail::judge_jump(watch, second, warm);
  detail::widen(watch.jerk, second);
  if (watch.filled > 2 * kEncoderLag) {
    detail::judge_stop(watch, step, warm);
    const Scalar middle = position_before(watch, kEncoderLag);
    detail::widen(watch.way, q - middle);
    detail::widen(watch.stop, (q - middle) - (middle - position_before(watch, 2 * kEncoderLag)));
  }
  if (++watch.window_ticks < 3 * kEncoderLag) return;
  watch.window_ticks = 0;
  detail::move_on(watch.jerk, Scalar(0.999));
  detail::move_on(watch.stop, Scalar(0.999));
  detail::move_on(watch.way, Scalar(0.999));
}

}  // namespace offnominal
