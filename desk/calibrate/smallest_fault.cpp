#include "calibrate/smallest_fault.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace offnominal::desk {
namespace {

using Eigen::Index;

constexpr double kMargin = 1.25;            // r of the detection-time bound
constexpr double kWindowTimeConstants = 5;  // after that the filter has seen 99 % of a fault
constexpr Index kMostBeginnings = 400;      // per recording
constexpr double kShareSeen = 0.95;

double share(std::vector<double>& values, double of) {
  if (values.empty()) return 0;
  const auto place = static_cast<std::ptrdiff_t>(of * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

// A fault of 1 behind the filter, sample by sample from its beginning, for a recording's own
// period.
std::vector<double> passed_by(double alpha_per_s, double period_s, double window_s) {
  std::vector<double> passed;
  const auto window = static_cast<Index>(window_s / period_s);
  for (Index k = 1; k <= window; ++k) {
    passed.push_back(-std::expm1(-alpha_per_s * period_s * static_cast<double>(k)));
  }
  return passed;
}

// One sign of a fault that begins at one sample of one recording. Before the first alarm nothing is
// learnt: the fault adds to the residual what the filter passes.
struct Beginning {
  const RecordedError& recording;
  const Eigen::VectorXd& threshold;
  const std::vector<double>& passed;
  Index from = 0;
  double sign = 1;

  // The smallest torque that crosses the threshold while the window lasts.
  [[nodiscard]] double least_torque() const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < passed.size(); ++k) least = std::min(least, left(k) / passed[k]);
    return least;
  }

  // When this torque crosses it; `otherwise` where it does not.
  [[nodiscard]] double delay(double torque, double otherwise) const {
    for (std::size_t k = 0; k < passed.size(); ++k) {
      if (torque * passed[k] > left(k)) return recording.period_s * static_cast<double>(k + 1);
    }
    return otherwise;
  }

 private:
  [[nodiscard]] double left(std::size_t k) const {
    const Index at = from + 1 + static_cast<Index>(k);
    return threshold[at] - sign * recording.error(at, 0);
  }
};

// Of every beginning what `of(beginning)` says of the sign of which it says more: of either sign
// that holds.
template <typename Of>
std::vector<double> over_beginnings(const std::vector<RecordedError>& recordings,
                                    const std::vector<Eigen::VectorXd>& thresholds,
                                    double alpha_per_s, double window_s, const Of& of) {
  std::vector<double> all;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const std::vector<double> passed = passed_by(alpha_per_s, recordings[r].period_s, window_s);
    const Index last = recordings[r].samples() - static_cast<Index>(passed.size()) - 1;
    const Index step = std::max<Index>(1, last / kMostBeginnings);
    for (Index from = 0; from < last; from += step) {
      const Beginning up{recordings[r], thresholds[r], passed, from, 1};
      const Beginning down{recordings[r], thresholds[r], passed, from, -1};
      all.push_back(std::max(of(up), of(down)));
    }
  }
  return all;
}

// No place in the table and no start of a run brings the threshold above this.
double largest_threshold(const JointBoundSettings& bound, double alpha_per_s) {
  return *std::max_element(bound.value.begin(), bound.value.end()) +
         2 * alpha_per_s * bound.momentum_error;
}

}  // namespace

SmallestFault smallest_fault(const std::vector<RecordedError>& recordings,
                             const std::vector<Eigen::VectorXd>& thresholds,
                             const JointBoundSettings& bound, double alpha_per_s,
                             const FaultWindows& windows) {
  SmallestFault fault;
  double longest_period_s = 0;
  for (const RecordedError& recording : recordings) {
    longest_period_s = std::max(longest_period_s, recording.period_s);
  }
  fault.certain = 2 * largest_threshold(bound, alpha_per_s);
  fault.certain_with = kMargin * fault.certain;
  // The sample that shows it may be a period later.
  fault.certain_s = std::log(kMargin / (kMargin - 1)) / alpha_per_s + longest_period_s;
  fault.window_s = windows.whole_s.value_or(kWindowTimeConstants / alpha_per_s);
  const auto seen_within = [&](double window_s) {
    std::vector<double> needed =
        over_beginnings(recordings, thresholds, alpha_per_s, window_s,
                        [](const Beginning& one) { return one.least_torque(); });
    return share(needed, kShareSeen);
  };
  fault.usual = seen_within(fault.window_s);
  fault.soon = seen_within(windows.soon_s.value_or(0.5 * fault.window_s));
  std::vector<double> delays = over_beginnings(
      recordings, thresholds, alpha_per_s, fault.window_s,
      [&](const Beginning& one) { return one.delay(2 * fault.usual, fault.window_s); });
  fault.twice_s = share(delays, 0.5);
  return fault;
}

}  // namespace offnominal::desk
