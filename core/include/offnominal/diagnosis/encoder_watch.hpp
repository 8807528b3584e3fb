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

// How long a joint stands while another one moves, ticks: now, and at most at an earlier time
// without a fault. It ends when the joint moves.
struct Standing {
  std::uint32_t alone = 0;
  std::uint32_t longest_alone = 0;
};

// What is seen of one joint's positions. Plain data.
template <typename Scalar>
struct EncoderWatch {
  // Positions of the last samples, the newest at `newest`, older ones before it, round and round.
  std::array<Scalar, 2 * kEncoderLag + 1> q{};
  std::uint8_t newest = 0;
  std::uint8_t window_ticks = 0;  // since the windows of the largest were moved on
  std::uint32_t filled = 0;       // samples in a row, up to the largest number
  std::uint32_t known_for = 0;    // samples in all, up to the largest number
  std::uint32_t still = 0;        // ticks with the same position
  std::uint32_t slow_for = 0;     // ticks with nearly the same, but for a count now and then
  std::uint8_t fast_for = 0;      // samples in a row without, up to 255
  Standing exact;                 // with the same position
  Standing slow;                  // with nearly the same: what is held gives way a little
  bool stopped_at_once = false;   // within one tick; while `stopped`
  bool stopped = false;           // too hard for a joint; until it moves again
  std::uint32_t steps = 0;        // other than 0, since the watch began, up to the largest number
  Scalar last_step{};             // the last that was not 0
  // Largest second difference over one tick and over the lag, and largest way over the lag: of this
  // window, of the one before, and of all before that.
  std::array<Scalar, 3> jerk{};
  std::array<Scalar, 3> stop{};
  std::array<Scalar, 3> way{};
  Scalar candidate{};                            // a step that may be a jump: the next sample tells
  Scalar jump{};                                 // the last one that was, rad or m
  std::uint32_t since_jump = ~std::uint32_t{0};  // ticks
};

namespace detail {

inline constexpr std::uint32_t kEncoderWarmUp = 200;  // samples
inline constexpr std::uint32_t kStepsWarmUp = 100;    // of them, with another position

// A second difference this many times larger than any before is no motion.
template <typename Scalar>
inline constexpr Scalar kBeyondMotion = 4;

template <typename Scalar>
[[nodiscard]] Scalar position_before(const EncoderWatch<Scalar>& watch, std::size_t ticks) {
  const std::size_t size = watch.q.size();
  return watch.q[(watch.newest + size - ticks) % size];
}

// Up to the largest number.
[[nodiscard]] constexpr std::uint32_t more(std::uint32_t count, std::uint32_t by = 1) {
  return count + std::min(by, ~std::uint32_t{0} - count);
}

// Slower than it is at its fastest by so much that it may be held.
template <typename Scalar>
[[nodiscard]] bool is_slow(const EncoderWatch<Scalar>& watch) {
  const Scalar way = watch.q[watch.newest] - position_before(watch, kEncoderLag);
  return Eigen::numext::abs(way) <= watch.way[2] / 50;
}

// One count is on its way for a lag, and by itself no motion.
template <typename Scalar>
void count_slow(EncoderWatch<Scalar>& watch, std::uint32_t ticks) {
  const bool slow = is_slow(watch);
  watch.fast_for = slow ? 0 : static_cast<std::uint8_t>(std::min(watch.fast_for + 1, 255));
  const bool moves = watch.fast_for > kEncoderLag + 2;
  watch.slow_for = moves ? 0 : more(watch.slow_for, slow || watch.slow_for > 0 ? ticks : 0);
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

// Seen moving for long enough to know how it moves: of a joint that stands, one count of its
// encoder would be beyond all motion.
template <typename Scalar>
[[nodiscard]] bool is_warm(const EncoderWatch<Scalar>& watch) {
  return watch.known_for > kEncoderWarmUp && watch.steps > kStepsWarmUp;
}
// Beyond any step that its fastest motion takes.
template <typename Scalar>
[[nodiscard]] Scalar beyond_steps(const EncoderWatch<Scalar>& watch) {
  return 3 * watch.way[2] / static_cast<Scalar>(kEncoderLag);
}

// Whether the newest second difference takes the candidate back: then it was a jump. Beyond what
// any force does to a joint, which is the way of a tick or two, that is enough. A smaller one has
// to leave the joint moving as it moved before, which no knock does.
template <typename Scalar>
void judge_jump(EncoderWatch<Scalar>& watch, Scalar step, Scalar second, bool warm) {
  const Scalar size = Eigen::numext::abs(watch.candidate);
  if (size > 0) {
    const Scalar rest = Eigen::numext::abs(second + watch.candidate);
    const Scalar usual = 2 * watch.jerk[2];
    const bool goes_on = rest < usual && Eigen::numext::abs(step) > usual;
    if (goes_on || (size > beyond_steps(watch) && rest < Scalar(0.3) * size)) {
      watch.jump = watch.candidate;
      watch.since_jump = 0;
    }
  }
  const bool beyond =
      warm && Eigen::numext::abs(second) > 2 * kBeyondMotion<Scalar> * watch.jerk[2];
  watch.candidate = beyond && watch.since_jump > 0 ? second : Scalar(0);
}

// A sample behind a few ticks that were not seen: whether it is neither where the joint was, nor
// where it was going, nor between, by more than a tick or two of its fastest and than any force
// does to it in as many. What stops meanwhile has not jumped.
template <typename Scalar>
void judge_gap(EncoderWatch<Scalar>& watch, Scalar q, std::uint32_t ticks) {
  if (!is_warm(watch) || watch.filled < 2 || ticks > kEncoderLag) return;
  const auto passed = static_cast<Scalar>(ticks);
  const Scalar last = position_before(watch, 0);
  const Scalar going = last + passed * (last - position_before(watch, 1));
  const Scalar off = q - std::clamp(q, std::min(last, going), std::max(last, going));
  const Scalar bent = kBeyondMotion<Scalar> * watch.jerk[2] * passed * (passed + 1);
  if (!(Eigen::numext::abs(off) > std::max(beyond_steps(watch), bent))) return;
  watch.jump = q - going;
  watch.since_jump = 0;
}

template <typename Scalar>
void count_stop(EncoderWatch<Scalar>& watch, Scalar step, std::uint32_t ticks) {
  if (step == 0) {
    watch.still = more(watch.still, ticks);
    return;
  }
  watch.last_step = step / static_cast<Scalar>(ticks);
  watch.still = 0;
  watch.stopped = watch.stopped_at_once = false;
}

template <typename Scalar>
void judge_stop(EncoderWatch<Scalar>& watch, bool warm) {
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

// Takes the next sample's position, rad or m, `ticks` >= 1 after the last one. Where samples are
// missing between them, or were refused because of what the encoder said, what spans them is judged
// by how far the joint has come.
template <typename Scalar>
void look_at(EncoderWatch<Scalar>& watch, Scalar q, std::uint32_t ticks = 1) {
  using detail::position_before;
  watch.since_jump = detail::more(watch.since_jump, ticks);
  if (ticks != 1) {
    detail::judge_gap(watch, q, ticks);
    watch.filled = 0;
  }
  const Scalar last = watch.q[watch.newest];
  watch.newest = static_cast<std::uint8_t>((watch.newest + 1U) % watch.q.size());
  watch.q[watch.newest] = q;
  watch.filled = detail::more(watch.filled);
  const Scalar step = q - last;
  if (watch.known_for > 0) detail::count_stop(watch, step, ticks);
  detail::count_slow(watch, ticks);
  watch.known_for = detail::more(watch.known_for);
  if (watch.filled < 3) return;
  if (step != 0) watch.steps = detail::more(watch.steps);
  const bool warm = detail::is_warm(watch);
  const Scalar second = step - (last - position_before(watch, 2));
  detail::judge_jump(watch, step, second, warm);
  detail::widen(watch.jerk, second);
  if (watch.filled > 2 * kEncoderLag) {
    detail::judge_stop(watch, warm);
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

// Takes one sample, `ticks` after the last one. `healthy`: no fault is known yet; a time counts for
// the longest when it has ended.
inline void count_alone(Standing& standing, bool stands, bool others_move, bool healthy,
                        std::uint32_t ticks = 1) {
  if (stands) {
    if (others_move) standing.alone = detail::more(standing.alone, ticks);
    return;
  }
  if (healthy) standing.longest_alone = std::max(standing.longest_alone, standing.alone);
  standing.alone = 0;
}

}  // namespace offnominal
