#include "explain/doctor_signal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/time_words.hpp"
#include "explain/doctor_checks.hpp"
#include "signal/quantile.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

std::vector<Burst> repeats_of(const VectorXd& x) {
  std::vector<Burst> bursts;
  for (Index i = 1; i < x.size(); ++i) {
    if (x[i] != x[i - 1]) continue;
    if (bursts.empty() || bursts.back().end() != i - 1) bursts.push_back({i - 1, 0});
    ++bursts.back().length;
  }
  return bursts;
}

VectorXd rows_passed(const Log& log) {
  const Index steps = log.sample_count() - 1;
  const VectorXd step = ((log.t_s.tail(steps) - log.t_s.head(steps)) / log.period_s).cwiseMax(1);
  VectorXd passed = step;
  if (steps < 2) return passed;
  passed.tail(steps - 1) = passed.tail(steps - 1).cwiseMax(step.head(steps - 1));
  passed.head(steps - 1) = passed.head(steps - 1).cwiseMax(step.tail(steps - 1));
  return passed;
}

bool is_next_to_gap(const Log& log, const Burst& burst) {
  constexpr Index kNear = 64;
  return std::any_of(log.gaps.begin(), log.gaps.end(), [&](const RowSpan& gap) {
    return burst.first <= gap.last + kNear && burst.end() + 2 >= gap.first;
  });
}

std::vector<Index> repeats_before_of(const VectorXd& x) {
  std::vector<Index> before(static_cast<std::size_t>(x.size()), 0);
  for (Index i = 1; i < x.size(); ++i) {
    before[static_cast<std::size_t>(i)] =
        before[static_cast<std::size_t>(i - 1)] + (x[i] == x[i - 1] ? 1 : 0);
  }
  return before;
}

double own_repeats(const std::vector<Index>& repeats_before, const Burst& burst) {
  // Samples on either side that tell how often this channel repeats a value of its own accord.
  constexpr Index kSurroundings = 100;
  const auto rows = static_cast<Index>(repeats_before.size());
  const Index low = std::max<Index>(burst.first - kSurroundings, 0);
  const Index high = std::min(burst.end() + 1 + kSurroundings, rows - 1);
  const auto count = [&](Index from, Index to) {
    return to <= from ? 0.0
                      : static_cast<double>(repeats_before[static_cast<std::size_t>(to)] -
                                            repeats_before[static_cast<std::size_t>(from)]);
  };
  const auto around =
      static_cast<double>((burst.first - low) + std::max<Index>(high - burst.end(), 0));
  if (around < 1) return 1;
  const double share = (count(low, burst.first) + count(burst.end(), high)) / around;
  return std::min(1.0, share + 2 * std::sqrt(share * (1 - share) / around) + 3 / around);
}

Rounding::Rounding(const VectorXd& x) : smallest_(smallest_step(x)) {
  constexpr int kFewest = 4;
  constexpr int kMost = 8;
  constexpr double kExact = 1e-9;
  for (int digits = kFewest; digits <= kMost && digits_ == 0; ++digits) {
    const bool all = std::all_of(x.begin(), x.end(), [digits](double value) {
      if (value == 0) return true;
      const double unit = std::pow(10.0, digits - 1 - std::floor(std::log10(std::abs(value))));
      const double scaled = std::abs(value) * unit;
      return std::abs(scaled - std::round(scaled)) <= kExact * scaled;
    });
    if (all) digits_ = digits;
  }
}

double Rounding::at(double value) const {
  if (digits_ == 0 || value == 0) return smallest_;
  return std::max(smallest_, std::pow(10.0, std::floor(std::log10(std::abs(value))) + 1 - digits_));
}

bool stands_still(const VectorXd& q) {
  constexpr double kFewestSteps = 16;
  const double step = Rounding(q).at(q.cwiseAbs().maxCoeff());
  return !(q.maxCoeff() - q.minCoeff() > kFewestSteps * step);
}

namespace {

// How far a joint may come that is held, rad or m.
double held_within(const RobotDescription& robot, Index joint) {
  constexpr double kHeldRad = 0.05;
  constexpr double kHeldM = 0.005;
  const JointType type = robot.joints[static_cast<std::size_t>(joint)].joint.type;
  return type == JointType::kRevolute ? kHeldRad : kHeldM;
}

// The farthest way within a second by the velocity alone; a sensor's zero does not add up to it.
double way_by_velocity(const VectorXd& dq, double period_s) {
  const auto rows = std::max<Index>(1, std::lround(1 / period_s));
  double farthest = 0;
  for (Index first = 0; first < dq.size(); first += rows) {
    const Index count = std::min(rows, dq.size() - first);
    const VectorXd centred = dq.segment(first, count).array() - dq.mean();
    farthest = std::max(farthest, std::abs(centred.sum()) * period_s);
  }
  return farthest;
}

}  // namespace

std::vector<char> held_joints(const Log& log, const RobotDescription& robot) {
  std::vector<char> held = held_joints(log.q, robot);
  for (std::size_t joint = 0; joint < held.size(); ++joint) {
    if (held[joint] == 0 || log.dq_derived[joint]) continue;
    const auto at = static_cast<Index>(joint);
    if (way_by_velocity(log.dq.col(at), log.period_s) > held_within(robot, at)) held[joint] = 0;
  }
  return held;
}

std::vector<char> held_joints(const Eigen::MatrixXd& q, const RobotDescription& robot) {
  constexpr double kOthersMove = 10;  // times as far
  VectorXd way = (q.colwise().maxCoeff() - q.colwise().minCoeff()).transpose();
  for (Index joint = 0; joint < q.cols(); ++joint) way[joint] /= held_within(robot, joint);
  const double most = way.size() == 0 ? 0 : way.maxCoeff();
  std::vector<char> held;
  for (const double one : way) {
    held.push_back(static_cast<char>(one < 1 && most >= kOthersMove * one && most > 1));
  }
  return held;
}

bool is_noisy_around(const VectorXd& x, const Burst& burst) {
  constexpr Index kNear = 200;
  constexpr Index kFewest = 30;
  // Of the fourth difference: 70 times the variance of white noise, whose neighbours have -0.8 in
  // common; of a motion they are all but the same.
  constexpr double kGain = 8.366600265340756;
  constexpr double kAlternates = -0.4;
  constexpr double kSmallShare = 0.1;
  constexpr double kAboveSteps = 3;
  std::vector<double> fourth;
  std::vector<double> changes;
  double both = 0;
  double alone = 0;
  const auto take = [&](Index from, Index to) {
    double before = 0;
    for (Index i = from; i + 4 < to; ++i) {
      const double d = x[i] - 4 * x[i + 1] + 6 * x[i + 2] - 4 * x[i + 3] + x[i + 4];
      if (i > from) both += d * before;
      alone += d * d;
      before = d;
      fourth.push_back(std::abs(d));
      if (x[i + 1] != x[i]) changes.push_back(std::abs(x[i + 1] - x[i]));
    }
  };
  take(std::max<Index>(burst.first - kNear, 0), burst.first);
  take(burst.end() + 1, std::min(burst.end() + 1 + kNear, x.size()));
  if (static_cast<Index>(fourth.size()) < kFewest || 2 * changes.size() < fourth.size())
    return false;
  if (!(both < kAlternates * alone)) return false;
  const auto of = [](std::vector<double>& values, double share) {
    const auto at = values.begin() +
                    static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  constexpr double kOfMedian = 0.6745;  // the median of |noise|, in standard deviations
  return of(fourth, 0.5) / kOfMedian / kGain > kAboveSteps * of(changes, kSmallShare);
}

double usual_change_of_pace(const VectorXd& x, Index width, int events) {
  const Index count = x.size() - 2 * width;
  if (count < 1) return 0;
  VectorXd change(count);
  for (Index i = 0; i < count; ++i) {
    change[i] = std::abs(x[i + 2 * width] - 2 * x[i + width] + x[i]);
  }
  const double share = 1 - static_cast<double>(2 * width * events) / static_cast<double>(count);
  return quantile(change, std::max(share, 0.9));
}

void set_spans(const Log& log, const std::vector<RowSpan>& spans, DataFault& fault) {
  for (const RowSpan& samples : spans) {
    const RowSpan rows = log.recorded_rows(samples);
    fault.spans.push_back(
        {samples, rows.first + 1, rows.last + 1, log.t_s[samples.first], log.t_s[samples.last]});
  }
  std::sort(fault.spans.begin(), fault.spans.end(), [](const FaultSpan& a, const FaultSpan& b) {
    return a.samples.first < b.samples.first;
  });
  if (!fault.spans.empty()) fault.at_s = fault.spans.front().from_s;
}

std::string words_of(const FaultSpan& span) {
  return fmt::format("rows {} to {}, {} to {} s", span.first_row, span.last_row,
                     words_of_time(span.from_s), words_of_time(span.to_s));
}

std::string words_of_spans(const DataFault& fault) {
  if (fault.spans.empty()) return {};
  const auto longest = std::max_element(
      fault.spans.begin(), fault.spans.end(),
      [](const FaultSpan& a, const FaultSpan& b) { return a.samples.count() < b.samples.count(); });
  std::string words = words_of(*longest);
  if (fault.spans.size() > 1) {
    words += fmt::format(", and {} stretch{} more", fault.spans.size() - 1,
                         fault.spans.size() == 2 ? "" : "es");
  }
  return words;
}

}  // namespace offnominal::desk
