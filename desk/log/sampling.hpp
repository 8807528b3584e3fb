#pragma once

#include "log/log.hpp"

namespace offnominal::desk {

// What the time stamps of a recording are like. t_s ascends strictly and has at least 2 samples.
struct Sampling {
  double mean_period_s = 0;
  double median_period_s = 0;
  double jitter = 0;  // largest |step / mean step - 1|
  double largest_gap_s = 0;
  double largest_gap_at_s = 0;  // time stamp before that gap
};
Sampling sampling_of(const Eigen::Ref<const Eigen::VectorXd>& t_s);

// Sets period_s of a log whose steps are even to within kSamplingJitter (read_log.hpp). Of any
// other a remark says what was done: up to 1 % of the rows stamped off, by 3 periods at most, are
// taken as even; rows that are even but for those that are missing are put on their grid with their
// own values, and the missing ones filled in; all else is resampled to its median step, and the
// rows stay as `recorded`; of rows stamped less than a quarter of a step apart, which came at once,
// the last counts for positions (at the start the first). Positions that are folded into a turn
// stay so. Where rows are missing, not just late, for more than kMaxGap steps and kShortestGapS,
// the samples of the grid in between are `gaps` of the log: straight lines, which no analysis may
// use. Of a recording with a gap of more than kLongestGapS only the longest part between such gaps
// is kept; the rest is `cut`. Throws InputError where the grid would have more than 4 times the
// rows that there are, and more than 100 000.
void make_even(Log& log);

// Shorter ones hold nothing that a motion could do meanwhile.
inline constexpr double kShortestGapS = 0.01;
inline constexpr double kLongestGapS = 10;

// The low-pass of the positions that velocities are derived from: 100 Hz, a fifth of the sampling
// rate where that is less.
double derived_velocity_cutoff_hz(double sample_rate_hz);

// Fills dq of the joints marked dq_derived: q low-passed without phase, then central differences.
// Needs period_s.
void derive_velocities(Log& log);

}  // namespace offnominal::desk
