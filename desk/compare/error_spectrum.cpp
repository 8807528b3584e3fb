#include "compare/error_spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "signal/periodogram.hpp"

namespace offnominal::desk {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::VectorXd;

constexpr double kTwoPi = 6.283185307179586;
constexpr int kMostSteps = 1000;
// Of each width of a window: a peak between two steps loses a sixth of its height at most.
constexpr double kStepsPerWidth = 2;
constexpr Index kFewestSamples = 16;
constexpr double kSlow = 0.1;  // of the greatest speed

// 1 in the middle of `from` to `from + width`, 0 at its ends.
ArrayXd hann(const Eigen::Ref<const ArrayXd>& at, double from, double width) {
  return (kTwoPi / 2 * (at - from) / width).sin().square();
}

std::vector<double> steps_up_to(double most, double width) {
  const double step = 1 / (kStepsPerWidth * width);
  std::vector<double> steps;
  // Below one period over the width there is nothing to be told from a constant.
  for (int k = static_cast<int>(kStepsPerWidth); k <= kMostSteps && k * step <= most; ++k) {
    steps.push_back(k * step);
  }
  return steps;
}

// Amplitudes at `at` of values with weights, about their weighted mean.
ArrayXd amplitudes(const ArrayXd& phase, const ArrayXd& values, const ArrayXd& weights,
                   const std::vector<double>& at) {
  const double all = weights.sum();
  if (!(all > 0)) return ArrayXd::Zero(static_cast<Index>(at.size()));
  const ArrayXd about = values - (weights * values).sum() / all;
  const std::vector<double> power =
      periodogram((kTwoPi * phase).matrix(), (weights * about).matrix(), at);
  return 2 / all * Eigen::Map<const ArrayXd>(power.data(), static_cast<Index>(power.size())).sqrt();
}

Spectrum spectrum_of(std::vector<double> at, const ArrayXd& amplitude) {
  return {std::move(at), {amplitude.data(), amplitude.data() + amplitude.size()}};
}

}  // namespace

Spectrum spectrum_over_time(const Eigen::Ref<const VectorXd>& t_s,
                            const Eigen::Ref<const VectorXd>& values, double most_hz) {
  if (t_s.size() < kFewestSamples || !(most_hz > 0)) return {};
  const double whole_s = t_s[t_s.size() - 1] - t_s[0];
  const double piece_s = std::min(whole_s, kMostSteps / (kStepsPerWidth * most_hz));
  std::vector<double> at = steps_up_to(most_hz, piece_s);
  if (at.empty()) return {};
  ArrayXd power = ArrayXd::Zero(static_cast<Index>(at.size()));
  // They overlap by half or more: the last one ends where the signal does.
  const auto pieces = static_cast<int>(std::ceil(2 * (whole_s / piece_s - 1) - 1e-9)) + 1;
  const double apart_s = pieces > 1 ? (whole_s - piece_s) / (pieces - 1) : 0;
  for (int piece = 0; piece < pieces; ++piece) {
    const double from_s = t_s[0] + piece * apart_s;
    const auto first = std::lower_bound(t_s.begin(), t_s.end(), from_s);
    const auto end = std::upper_bound(first, t_s.end(), from_s + piece_s);
    const Index at_first = first - t_s.begin();
    const Index count = end - first;
    const ArrayXd t = t_s.segment(at_first, count);
    power += amplitudes(t - from_s, values.segment(at_first, count), hann(t, from_s, piece_s), at)
                 .square();
  }
  return spectrum_of(std::move(at), (power / pieces).sqrt());
}

Spectrum spectrum_over_travel(const Eigen::Ref<const VectorXd>& t_s,
                              const Eigen::Ref<const VectorXd>& turns,
                              const Eigen::Ref<const VectorXd>& values, double most_hz) {
  const Index count = turns.size() - 1;
  if (count + 1 < kFewestSamples || !(most_hz > 0)) return {};
  const double low = turns.minCoeff();
  const double width = turns.maxCoeff() - low;
  if (!(width > 0)) return {};
  // Each step of the way counts by its length.
  const VectorXd travel = (turns.tail(count) - turns.head(count)).cwiseAbs();
  const VectorXd speed = travel.cwiseQuotient(t_s.tail(count) - t_s.head(count));
  const double most = std::min(0.5 / travel.maxCoeff(), most_hz / (kSlow * speed.maxCoeff()));
  std::vector<double> at = steps_up_to(most, width);
  if (at.empty()) return {};
  const ArrayXd phase = turns.head(count);
  const ArrayXd weights = hann(phase, low, width) * travel.array();
  const ArrayXd amplitude = amplitudes(phase - low, values.head(count), weights, at);
  return spectrum_of(std::move(at), amplitude);
}

}  // namespace offnominal::desk
