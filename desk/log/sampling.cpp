#include "log/sampling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "common/error.hpp"
#include "common/time_words.hpp"
#include "log/read_log.hpp"
#include "signal/differentiate.hpp"
#include "signal/fold.hpp"
#include "signal/resample.hpp"
#include "signal/zero_phase.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// What does not change does not change between its rows either.
bool is_constant(const VectorXd& values) { return values.minCoeff() == values.maxCoeff(); }

// The rows that a spline goes through: of rows that came at once, as what waited in a queue does,
// the last, which waited least. Through two of them it would have the slope of what the encoder
// moved meanwhile over hardly any time, and swing far beyond both.
std::vector<Index> knots_of(const VectorXd& t_s, double period_s) {
  constexpr double kAtOnce = 0.25;  // periods
  std::vector<Index> knots{t_s.size() - 1};
  for (Index i = t_s.size() - 2; i >= 0; --i) {
    if (t_s[knots.back()] - t_s[i] >= kAtOnce * period_s) knots.push_back(i);
  }
  // The grid begins at the first row.
  if (knots.back() != 0) knots.back() = 0;
  std::reverse(knots.begin(), knots.end());
  return knots;
}

// A spline through the jump of an angle that is folded into a turn would swing beyond both ends.
VectorXd position_at(const VectorXd& t_s, const VectorXd& q, const VectorXd& at_s) {
  if (is_constant(q)) return VectorXd::Constant(at_s.size(), q[0]);
  const KnownFold fold = known_fold_in_any_unit(q);
  if (!fold.folds.empty()) {
    VectorXd whole = q;
    unfold(whole, fold.range, fold.folds);
    VectorXd result = spline_at(t_s, whole, at_s);
    for (double& angle : result) {
      angle -= fold.range * std::floor((angle - fold.low) / fold.range);
    }
    return result;
  }
  return spline_at(t_s, q, at_s);
}

// What rests between two rows rests there: a spline rings about it, and the doctor would see the
// value move.
void keep_rests(const VectorXd& recorded_s, const VectorXd& q, const VectorXd& even_s,
                Eigen::Ref<VectorXd> result) {
  Index row = 0;
  for (Index i = 0; i < even_s.size(); ++i) {
    while (row + 2 < recorded_s.size() && recorded_s[row + 1] < even_s[i]) ++row;
    if (q[row] == q[row + 1]) result[i] = q[row];
  }
}

RecordedRows resample(Log& log, double period_s) {
  const VectorXd recorded = log.t_s;
  const double span_s = recorded[recorded.size() - 1] - recorded[0];
  const auto steps = static_cast<Index>(std::floor(span_s / period_s * (1 + 1e-12)));
  VectorXd even(steps + 1);
  for (Index i = 0; i <= steps; ++i) {
    even[i] = std::min(recorded[0] + static_cast<double>(i) * period_s, recorded[0] + span_s);
  }
  const auto resample_columns = [&](Eigen::MatrixXd& columns, auto&& interpolate) {
    Eigen::MatrixXd result(even.size(), columns.cols());
    for (Index j = 0; j < columns.cols(); ++j) {
      result.col(j) = interpolate(recorded, columns.col(j), even);
      keep_rests(recorded, columns.col(j), even, result.col(j));
    }
    return std::exchange(columns, std::move(result));
  };
  RecordedRows rows;
  const std::vector<Index> knots = knots_of(recorded, period_s);
  const VectorXd knots_s = recorded(knots);
  rows.q = resample_columns(log.q, [&](const VectorXd&, const VectorXd& q, const VectorXd& at_s) {
    return position_at(knots_s, q(knots), at_s);
  });
  rows.dq = resample_columns(log.dq, linear_at);
  rows.tau = resample_columns(log.tau, linear_at);
  if (log.sensor_tau.rows() > 0) resample_columns(log.sensor_tau, linear_at);
  for (auto& [name, values] : log.extra) values = linear_at(recorded, values, even);
  rows.t_s = recorded;
  log.t_s = std::move(even);
  return rows;
}

// Where rows are missing: the last row before, and the first after it.
struct Hole {
  Index before = 0;
  Index after = 0;
};

// Rows that were only stamped late are there: the stamps behind catch up with the clock.
std::vector<Hole> holes_of(const VectorXd& t_s, double period_s) {
  constexpr double kLateS = 0.03;  // a motion is not to be had from stamps that are later
  std::vector<Hole> holes;
  const double least_s = std::max(kMaxGap * period_s, kShortestGapS);
  for (Index i = 0; i + 1 < t_s.size(); ++i) {
    const double step_s = t_s[i + 1] - t_s[i];
    if (!(step_s > least_s)) continue;
    const double missing = step_s / period_s - 1;
    constexpr double kFarthest = 10000;  // rows
    const double bound = std::min({2 * missing, static_cast<double>(t_s.size()), kFarthest});
    const Index end = std::min(t_s.size() - 1, i + 1 + static_cast<Index>(bound));
    Index after = i + 1;
    for (Index j = i + 2; j <= end; ++j) {
      const double late = (t_s[j] - t_s[i]) / period_s - static_cast<double>(j - i);
      if (late > missing / 2) continue;
      after = j;
      break;
    }
    if (after > i + 1 && step_s < kLateS) continue;
    holes.push_back({i, after});
    i = after - 1;
  }
  return holes;
}

// Straight lines over these rows of every column, between the rows around them.
void draw_lines(Eigen::MatrixXd& columns, const RowSpan& rows) {
  const Index from = std::max<Index>(rows.first - 1, 0);
  const Index to = std::min(rows.last + 1, columns.rows() - 1);
  const Eigen::RowVectorXd change = columns.row(to) - columns.row(from);
  for (Index i = rows.first; i <= rows.last; ++i) {
    const double share = static_cast<double>(i - from) / static_cast<double>(to - from);
    columns.row(i) = columns.row(from) + share * change;
  }
}

// Whether anything was cut.
bool keep_longest_part(Log& log, const std::vector<Hole>& holes) {
  const Index rows = log.t_s.size();
  RowSpan part{0, rows - 1};
  RowSpan best{0, -1};
  const auto consider = [&](Index last) {
    part.last = last;
    if (part.count() > best.count()) best = part;
  };
  for (const Hole& hole : holes) {
    if (log.t_s[hole.after] - log.t_s[hole.before] <= kLongestGapS) continue;
    consider(hole.before);
    part.first = hole.after;
  }
  consider(rows - 1);
  if (best.count() == rows || best.count() < kMinSamples) return false;
  if (best.first > 0) log.cut.push_back({0, best.first - 1});
  if (best.last + 1 < rows) log.cut.push_back({best.last + 1, rows - 1});
  const auto keep = [&](VectorXd& values) {
    values = values.segment(best.first, best.count()).eval();
  };
  const auto keep_rows = [&](Eigen::MatrixXd& columns) {
    columns = columns.middleRows(best.first, best.count()).eval();
  };
  keep(log.t_s);
  keep_rows(log.q);
  keep_rows(log.dq);
  keep_rows(log.tau);
  if (log.sensor_tau.rows() > 0) keep_rows(log.sensor_tau);
  for (auto& [name, values] : log.extra) keep(values);
  return true;
}

// Before it is an index, and before there is no room for it.
void check_size(const Log& log, const Sampling& sampling) {
  constexpr double kMost = 4;  // times what was recorded
  constexpr double kAlways = 1e5;
  const double period_s = sampling.median_period_s;
  const Index rows = log.t_s.size();
  const double even = (log.t_s[rows - 1] - log.t_s[0]) / period_s;
  if (even <= std::max(kMost * static_cast<double>(rows), kAlways)) return;
  throw InputError(
      {log.file, fmt::format("t = {} s", words_of_time(sampling.largest_gap_at_s)),
       fmt::format("a gap of {:.4g} s, and {} rows where there should be {:.0f}",
                   sampling.largest_gap_s, rows, even),
       fmt::format("gaps up to {:g} s that leave a quarter of the rows, one each {:.4g} s",
                   kLongestGapS, period_s),
       "cut the recording at the gap"});
}

// How many stamps of rows that are all there are off by more than kSamplingJitter; none where they
// are too many, or too far off, for a clock that is only late at times.
std::optional<Index> stamps_off(const Eigen::Ref<const VectorXd>& t_s, double period_s) {
  constexpr double kMostRows = 0.01;
  constexpr double kMostPeriods = 3;
  const Index rows = t_s.size();
  const VectorXd even = VectorXd::LinSpaced(rows, t_s[0], t_s[rows - 1]);
  Index off = 0;
  for (Index i = 0; i < rows; ++i) {
    const double periods = std::abs(t_s[i] - even[i]) / period_s;
    if (periods > kMostPeriods) return std::nullopt;
    if (periods > kSamplingJitter) ++off;
  }
  if (static_cast<double>(off) > kMostRows * static_cast<double>(rows)) return std::nullopt;
  return off;
}

// It is a few stamps that are wrong then, and to put every other row elsewhere for them would be no
// better.
bool take_late_stamps_as_even(Log& log, const Sampling& sampling) {
  const auto off = stamps_off(log.t_s, sampling.mean_period_s);
  if (!off) return false;
  log.remarks.push_back(
      fmt::format("{} time stamp{} off by more than {:g} % of the sampling period: taken as even",
                  *off, *off == 1 ? " is" : "s are", 100 * kSamplingJitter));
  const Index rows = log.t_s.size();
  VectorXd even = VectorXd::LinSpaced(rows, log.t_s[0], log.t_s[rows - 1]);
  log.stamps_s = std::exchange(log.t_s, std::move(even));
  log.period_s = sampling.mean_period_s;
  return true;
}

// The rows between steps over which at least one is missing. A row that is late leaves none out:
// the one behind it is where it was to be expected.
std::vector<RowSpan> parts_of(const VectorXd& t_s, double period_s) {
  constexpr double kMissing = 1.5;  // periods, of one step
  std::vector<RowSpan> parts{{0, 0}};
  for (Index i = 1; i < t_s.size(); ++i) {
    const bool missing =
        t_s[i] - t_s[i - 1] > kMissing * period_s &&
        (i + 1 == t_s.size() || t_s[i + 1] - t_s[i - 1] > (1 + kMissing) * period_s);
    if (missing) parts.push_back({i, i});
    parts.back().last = i;
  }
  return parts;
}

// Period of rows that are even but for those that are missing; none where they are not.
std::optional<double> period_between(const VectorXd& t_s, const std::vector<RowSpan>& parts) {
  const auto span_s = [&](const RowSpan& part) { return t_s[part.last] - t_s[part.first]; };
  double sum_s = 0;
  Index steps = 0;
  for (const RowSpan& part : parts) {
    sum_s += span_s(part);
    steps += part.count() - 1;
  }
  if (steps < 1) return std::nullopt;
  const double period_s = sum_s / static_cast<double>(steps);
  for (const RowSpan& part : parts) {
    const double whole_s = period_s * static_cast<double>(part.count() - 1);
    if (std::abs(span_s(part) - whole_s) > period_s / 2 ||
        !stamps_off(t_s.segment(part.first, part.count()), period_s)) {
      return std::nullopt;
    }
  }
  return period_s;
}

// Rows that are even but for those that are missing are put on the grid that they are of: they keep
// their values to the last bit. Returns its period; none where they are not even, and nothing
// moved.
std::optional<double> put_on_grid(VectorXd& t_s, double period_s) {
  const std::vector<RowSpan> parts = parts_of(t_s, period_s);
  const auto period = period_between(t_s, parts);
  if (!period) return std::nullopt;
  const double from_s = t_s[0];
  Index next = 0;
  for (const RowSpan& part : parts) {
    const auto first = static_cast<Index>(std::llround((t_s[part.first] - from_s) / *period));
    next = std::max(first, next);
    for (Index i = part.first; i <= part.last; ++i) {
      t_s[i] = from_s + static_cast<double>(next++) * *period;
    }
  }
  return period;
}

// Straight lines over the holes, which are gaps of the log from now on.
void bridge(Log& log, const VectorXd& recorded_s, const std::vector<Hole>& holes) {
  // A sample of the grid so near a row is that row.
  const double same_s = kSamplingJitter * log.period_s;
  for (const Hole& hole : holes) {
    const auto begin = log.t_s.begin();
    RowSpan rows;
    rows.first = std::upper_bound(begin, log.t_s.end(), recorded_s[hole.before] + same_s) - begin;
    rows.last = std::lower_bound(begin, log.t_s.end(), recorded_s[hole.after] - same_s) - begin - 1;
    if (rows.count() < 1) continue;
    draw_lines(log.q, rows);
    draw_lines(log.dq, rows);
    draw_lines(log.tau, rows);
    if (log.sensor_tau.rows() > 0) draw_lines(log.sensor_tau, rows);
    log.gaps.push_back(rows);
  }
}

}  // namespace

Sampling sampling_of(const Eigen::Ref<const VectorXd>& t_s) {
  const Index steps = t_s.size() - 1;
  VectorXd period = t_s.tail(steps) - t_s.head(steps);
  Sampling sampling;
  sampling.mean_period_s = (t_s[steps] - t_s[0]) / static_cast<double>(steps);
  sampling.jitter = (period.array() / sampling.mean_period_s - 1).abs().maxCoeff();
  Index at = 0;
  sampling.largest_gap_s = period.maxCoeff(&at);
  sampling.largest_gap_at_s = t_s[at];
  double* const middle = period.data() + steps / 2;
  std::nth_element(period.data(), middle, period.data() + steps);
  sampling.median_period_s = *middle;
  return sampling;
}

void make_even(Log& log) {
  Sampling sampling = sampling_of(log.t_s);
  if (sampling.jitter <= kSamplingJitter) {
    log.period_s = sampling.mean_period_s;
    return;
  }
  if (take_late_stamps_as_even(log, sampling)) return;
  double period_s = sampling.median_period_s;
  VectorXd recorded = log.t_s;
  std::vector<Hole> holes = holes_of(recorded, period_s);
  if (keep_longest_part(log, holes)) {
    log.stamps_s = std::move(recorded);
    recorded = log.t_s;
    sampling = sampling_of(recorded);
    period_s = sampling.median_period_s;
    holes = holes_of(recorded, period_s);
    if (sampling.jitter <= kSamplingJitter) {
      log.period_s = sampling.mean_period_s;
      return;
    }
  }
  check_size(log, sampling);
  if (log.stamps_s.size() == 0) log.stamps_s = recorded;
  const Index before = log.cut.empty() || log.cut[0].first > 0 ? 0 : log.cut[0].last + 1;
  const auto grid_s = put_on_grid(log.t_s, period_s);
  if (grid_s) {
    log.remarks.push_back(fmt::format("rows are missing, one each {:.4g} s: filled in", *grid_s));
    recorded = log.t_s;
    log.stamps_s.segment(before, recorded.size()) = recorded;
  } else {
    log.remarks.push_back(
        fmt::format("sampling is not even (steps of {:.4g} s, off by up to {:.0f} % of their "
                    "mean): resampled to {:.4g} s",
                    period_s, 100 * sampling.jitter, period_s));
  }
  log.period_s = grid_s.value_or(period_s);
  RecordedRows rows = resample(log, log.period_s);
  rows.first = before;
  if (!grid_s) log.recorded = std::make_shared<const RecordedRows>(std::move(rows));
  bridge(log, recorded, holes);
}

double derived_velocity_cutoff_hz(double sample_rate_hz) {
  return std::min(100.0, sample_rate_hz / 5);
}

void derive_velocities(Log& log) {
  const double rate_hz = log.sample_rate_hz();
  const double cutoff_hz = derived_velocity_cutoff_hz(rate_hz);
  for (Index joint = 0; joint < log.q.cols(); ++joint) {
    if (!log.dq_derived[static_cast<std::size_t>(joint)]) continue;
    const VectorXd smooth = zero_phase_low_pass(log.q.col(joint), cutoff_hz, rate_hz);
    log.dq.col(joint) = central_difference(smooth, log.period_s);
  }
}

}  // namespace offnominal::desk
