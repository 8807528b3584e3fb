#include "compare/standstill.hpp"

#include <algorithm>
#include <cmath>

#include "signal/quantile.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr double kFewest = 0.1;  // of all samples that have to be left

}  // namespace

VectorXd samples_in_motion(const Log& log, Index joint, double counts_per_unit) {
  constexpr double kCounts = 2;  // that a position flickers by
  constexpr double kSlack = 1e-6;
  VectorXd moving = VectorXd::Ones(log.sample_count());
  if (log.at_rest || !(counts_per_unit > 0)) return moving;
  const double flicker = (kCounts + kSlack) / counts_per_unit;
  const auto shortest = static_cast<Index>(std::ceil(kStandstillS * log.sample_rate_hz()));
  const auto q = log.q.col(joint);
  for (Index first = 0; first < q.size();) {
    double low = q[first];
    double high = q[first];
    Index last = first;
    while (last + 1 < q.size() &&
           std::max(high, q[last + 1]) - std::min(low, q[last + 1]) <= flicker) {
      ++last;
      low = std::min(low, q[last]);
      high = std::max(high, q[last]);
    }
    if (last - first < shortest) {
      ++first;
      continue;
    }
    moving.segment(first, last + 1 - first).setZero();
    first = last + 1;
  }
  return moving;
}

VectorXd moving_samples(const Log& log, Index joint, double counts_per_unit) {
  VectorXd moving = samples_in_motion(log, joint, counts_per_unit);
  if (moving.mean() < kFewest) moving.setOnes();
  return moving;
}

void leave_out_sticking(const VectorXd& speed, double top_speed, double period_s,
                        Eigen::Ref<VectorXd> moving) {
  constexpr double kAllButStands = 0.02;  // of the top speed
  constexpr double kNearZero = 0.1;       // of that
  constexpr double kShortestS = 0.1;
  constexpr double kSmearedS = 0.04;  // on either side
  const auto samples_in = [&](double time_s) {
    return static_cast<Index>(std::lround(time_s / period_s));
  };
  const double slow = kAllButStands * top_speed;
  VectorXd left = moving;
  for (Index first = 0; first < speed.size(); ++first) {
    if (!(std::abs(speed[first]) <= slow)) continue;
    Index last = first;
    while (last + 1 < speed.size() && std::abs(speed[last + 1]) <= slow) ++last;
    const Index count = last - first;
    const double slowest = speed.segment(first, count + 1).cwiseAbs().minCoeff();
    const bool sticks = count < samples_in(kStandstillS) || slowest <= kNearZero * slow;
    if (count >= samples_in(kShortestS) && sticks) {
      const Index from = std::max<Index>(0, first - samples_in(kSmearedS));
      const Index to = std::min(speed.size() - 1, last + samples_in(kSmearedS));
      left.segment(from, to + 1 - from).setZero();
    }
    first = last;
  }
  if (left.mean() >= kFewest) moving = left;
}

VectorXd samples_that_tell(const Log& log, const RobotDescription& robot, Index joint,
                           const VectorXd& speed) {
  VectorXd tell = moving_samples(
      log, joint, robot.joints[static_cast<std::size_t>(joint)].encoder.counts_per_unit);
  if (log.at_rest) return tell;
  leave_out_sticking(speed, quantile(speed.cwiseAbs(), kTopSpeedShare), log.period_s, tell);
  return tell;
}

}  // namespace offnominal::desk
