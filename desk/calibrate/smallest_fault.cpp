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

// Of every beginning and sign, what `of(residual, threshold, from, sign)` says.
template <typename Of>
std::vector<double> over_beginnings(const std::vector<RecordedError>& recordings,
                                    const std::vector<Eigen::VectorXd>& thresholds, Index window,
                                    const Of& of) {
  std::vector<double> all;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const Eigen::VectorXd& residual = recordings[r].residual;
    const Index last = residual.size() - window - 1;
    const Index step = std::max<Index>(1, last / kMostBeginnings);
    for (Index from = 0; from < last; from += step) {
      for (const double sign : {-1.0, 1.0}) all.push_back(of(residual, thresholds[r], from, sign));
    }
  }
  return all;
}

}  // namespace

SmallestFault smallest_fault(const std::vector<RecordedError>& recordings,
                             const std::vector<Eigen::VectorXd>& thresholds, double alpha_per_s) {
  SmallestFault fault;
  for (const Eigen::VectorXd& threshold : thresholds) {
    fault.certain = std::max(fault.certain, 2 * threshold.maxCoeff());
  }
  fault.certain_with = kMargin * fault.certain;
  fault.certain_s = std::log(kMargin / (kMargin - 1)) / alpha_per_s;
  fault.window_s = kWindowTimeConstants / alpha_per_s;
  const double period_s = recordings.front().period_s;
  const auto window = static_cast<Index>(fault.window_s / period_s);
  std::vector<double> passed;  // by the filter, of a fault of 1, so many samples later
  for (Index k = 1; k <= window; ++k) {
    passed.push_back(-std::expm1(-alpha_per_s * period_s * static_cast<double>(k)));
  }
  // Before the first alarm nothing is learnt: a fault adds to the residual what the filter passes.
  std::vector<double> needed =
      over_beginnings(recordings, thresholds, window,
                      [&](const auto& residual, const auto& threshold, Index from, double sign) {
                        double least = std::numeric_limits<double>::infinity();
                        for (Index k = 1; k <= window; ++k) {
                          const double left = threshold[from + k] - sign * residual[from + k];
                          least = std::min(least, left / passed[static_cast<std::size_t>(k - 1)]);
                        }
                        return least;
                      });
  fault.usual = share(needed, kShareSeen);
  std::vector<double> delays = over_beginnings(
      recordings, thresholds, window,
      [&](const auto& residual, const auto& threshold, Index from, double sign) {
        for (Index k = 1; k <= window; ++k) {
          const double torque =
              sign * residual[from + k] + 2 * fault.usual * passed[static_cast<std::size_t>(k - 1)];
          if (torque > threshold[from + k]) return period_s * static_cast<double>(k);
        }
        return fault.window_s;
      });
  fault.twice_s = share(delays, 0.5);
  return fault;
}

}  // namespace offnominal::desk
