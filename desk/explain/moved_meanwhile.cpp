#include "explain/moved_meanwhile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "signal/quantile.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Rows between two times; none: the mean of nothing.
class Window {
 public:
  Window(const Log& log, double from_s, double to_s) {
    const auto begin = log.t_s.begin();
    first_ = std::lower_bound(begin, log.t_s.end(), from_s) - begin;
    count_ = std::upper_bound(begin, log.t_s.end(), to_s) - begin - first_;
  }
  [[nodiscard]] bool is_empty() const { return count_ <= 0; }
  [[nodiscard]] double mean_of(const VectorXd& x) const { return x.segment(first_, count_).mean(); }

 private:
  Index first_ = 0;
  Index count_ = 0;
};

// Within a second outside a burst, mostly: a level that the fault shifts is none.
double usual_deviation(const VectorXd& x, const Burst& burst, Index rows_of_a_second) {
  constexpr double kMostly = 0.84;
  std::vector<double> deviations;
  for (Index first = 0; first + rows_of_a_second <= x.size(); first += rows_of_a_second) {
    if (first <= burst.end() + rows_of_a_second && first + rows_of_a_second > burst.first) continue;
    const auto second = x.segment(first, rows_of_a_second).array();
    deviations.push_back(std::sqrt((second - second.mean()).square().mean()));
  }
  if (deviations.empty()) return std::numeric_limits<double>::infinity();
  return quantile(
      Eigen::Map<const VectorXd>(deviations.data(), static_cast<Index>(deviations.size())),
      kMostly);
}

}  // namespace

MovedMeanwhile moved_meanwhile(const Log& log, const Burst& burst, const ExpectedTorque& expected) {
  // The model's low-pass smears the jump, and the abrupt stop, and their accelerations.
  constexpr double kAwayS = 0.3;
  constexpr double kWindowS = 0.1;
  constexpr double kTells = 5;  // standard deviations of what the model misses elsewhere
  constexpr double kAlike = 0.4;
  const double from_s = log.t_s[burst.first];
  const double to_s = log.t_s[burst.end()];
  const Window before(log, from_s - kAwayS - kWindowS, from_s - kAwayS);
  const Window at_end(log, to_s - kAwayS - kWindowS, to_s - kAwayS);
  const Window behind(log, to_s + kAwayS, to_s + kAwayS + kWindowS);
  if (before.is_empty() || at_end.is_empty() || behind.is_empty() ||
      to_s - from_s < 2 * kAwayS + kWindowS) {
    return MovedMeanwhile::kUnknown;
  }
  const auto rows_of_a_second = std::max<Index>(8, std::lround(1 / log.period_s));
  double most = kTells;
  MovedMeanwhile moved = MovedMeanwhile::kUnknown;
  for (Index joint = 0; joint < log.tau.cols(); ++joint) {
    const VectorXd beyond = expected.torque_beyond(log, joint);
    const double deviation = usual_deviation(beyond, burst, rows_of_a_second);
    // Of a joint that moved meanwhile the model is wrong at the end of the burst alone; of one that
    // is counted from another zero it is as wrong there as before.
    const double gone = at_end.mean_of(beyond) - behind.mean_of(beyond);
    const double come = at_end.mean_of(beyond) - before.mean_of(beyond);
    if (!(std::abs(gone) > most * deviation)) continue;
    most = std::abs(gone) / deviation;
    const double share = come / gone;
    moved = std::abs(share - 1) < kAlike ? MovedMeanwhile::kYes
            : std::abs(share) < kAlike   ? MovedMeanwhile::kNo
                                         : MovedMeanwhile::kUnknown;
  }
  return moved;
}

}  // namespace offnominal::desk
