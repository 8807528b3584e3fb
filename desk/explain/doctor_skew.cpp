#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "common/parallel.hpp"
#include "explain/doctor_checks.hpp"
#include "signal/differentiate.hpp"
#include "signal/norm_about_mean.hpp"
#include "signal/resample.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Drives answer 2 to 6 ms late and a sample more is usual: an effect, not a fault.
constexpr double kHonestLagS = 0.008;
constexpr double kHonestLagPeriods = 2;  // of the recording
constexpr double kLargestLagS = 0.15;
constexpr double kLagStepS = 0.002;

double honest_lag(double period_s) { return std::max(kHonestLagS, kHonestLagPeriods * period_s); }

// What a model may lack on a joint, scaled to unit length; nothing in it knows about time.
MatrixXd nuisance_columns(const TorquePair& pair, Index joint, Index first, Index count) {
  const Index joints = pair.q.cols();
  MatrixXd columns(count, static_cast<Index>(pair.links.size()) + 6 + 2 * joints);
  Index next = 0;
  const auto add = [&](const VectorXd& column) {
    const double size = column.norm();
    columns.col(next++) = size > 0 ? VectorXd(column / size) : column;
  };
  const auto part = [&](const MatrixXd& of, Index column) -> VectorXd {
    return of.col(column).segment(first, count);
  };
  for (const MatrixXd& link : pair.links) add(part(link, joint));
  add(part(pair.model, joint) - part(pair.load, joint));
  add(VectorXd::Ones(count));
  add(part(pair.q, joint));
  add(part(pair.ddq, joint));
  for (Index other = 0; other < joints; ++other) {
    constexpr double kSignWidth = 0.02;  // of the top speed
    const VectorXd dq = part(pair.dq, other);
    const double width = std::max(kSignWidth * dq.cwiseAbs().maxCoeff(), 1e-9);
    const VectorXd sign = (dq.array() / width).tanh();
    add(dq);
    add(sign);
    if (other != joint) continue;
    add(dq.cwiseProduct(dq.cwiseAbs()));
    add(sign.cwiseProduct(part(pair.load, joint).cwiseAbs()));
  }
  return columns.leftCols(next);
}

}  // namespace

LagEstimate estimate_lag(const TorquePair& pair, Index joint, Index first, Index count,
                         double honest_s) {
  const MatrixXd columns = nuisance_columns(pair, joint, first, count);
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(columns);
  const MatrixXd basis =
      MatrixXd(qr.householderQ() * MatrixXd::Identity(count, columns.cols())).leftCols(qr.rank());
  const VectorXd own_t = pair.t_s.segment(first, count);
  const Spline measured(pair.t_s, pair.measured.col(joint));
  const auto steps = static_cast<Index>(kLargestLagS / kLagStepS);
  VectorXd errors(2 * steps + 1);
  for (Index k = 0; k < errors.size(); ++k) {
    const double lag = kLagStepS * static_cast<double>(k - steps);
    const VectorXd at = (own_t.array() + lag).max(pair.t_s[0]).min(pair.t_s[pair.t_s.size() - 1]);
    const VectorXd shifted = measured.at(at);
    errors[k] = std::max(shifted.squaredNorm() - (basis.transpose() * shifted).squaredNorm(), 0.0) /
                std::max(shifted.squaredNorm(), std::numeric_limits<double>::min());
  }
  LagEstimate estimate;
  Index best = 0;
  const double least = errors.minCoeff(&best);
  double honest = std::numeric_limits<double>::infinity();
  for (Index k = 0; k < errors.size(); ++k) {
    if (std::abs(kLagStepS * static_cast<double>(k - steps)) <= honest_s) {
      honest = std::min(honest, errors[k]);
    }
  }
  estimate.at_end = best == 0 || best + 1 == errors.size();
  estimate.lag_s = kLagStepS * static_cast<double>(best - steps);
  if (!estimate.at_end) {
    const double before = errors[best - 1] - least;
    const double after = errors[best + 1] - least;
    if (before + after > 0) {
      estimate.lag_s += kLagStepS * (before - after) / (2 * (before + after));
    }
  }
  // From the rigid body alone: noise is independent of everything, and how dry friction changes
  // sign is what a model knows least.
  const VectorXd rate =
      central_difference(pair.load.col(joint), pair.period_s).segment(first, count);
  if (rate.norm() > 0) {
    estimate.independence = (rate - basis * (basis.transpose() * rate)).norm() / rate.norm();
  }
  const double independent = 2 * pair.cutoff_hz * static_cast<double>(count) * pair.period_s;
  constexpr double kExact = 1e-12;
  estimate.likelihood = independent / 2 * std::log((honest + kExact) / (least + kExact));
  return estimate;
}

namespace {

// The lag on one half of the recording, as the joints that show it see it together.
struct CommonLag {
  int joints = 0;  // that show a lag at all
  double lag_s = 0;
  double likelihood = 0;
  bool agreed = false;
};

CommonLag common_lag(const TorquePair& pair, Index first, Index count, double honest_s) {
  // A clock is off for all joints alike; elasticity or friction make one joint late, or each
  // differently. Measured lags of one clock differ by less than this.
  constexpr double kAgreeS = 0.005;
  constexpr double kAgreeShare = 0.2;
  // Below this a lag looks like friction or a spring: one sine, or one speed to and fro, reach
  // 0.35; a motion with several frequencies starts at 0.7.
  constexpr double kIndependent = 0.5;
  // Time marks are changes of the rigid body's torque. Motions that are worth a fit change it by a
  // third of its size, poor ones by less than a tenth; the rest of the torque is friction.
  constexpr double kChanges = 0.15;
  constexpr double kOfMeasured = 0.3;
  CommonLag common;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  bool inside = true;
  std::vector<std::optional<LagEstimate>> lags(static_cast<std::size_t>(pair.q.cols()));
  parallel_for(lags.size(), threads_for(pair.q.size()), [&](std::size_t i) {
    const auto joint = static_cast<Index>(i);
    const VectorXd load = pair.load.col(joint).segment(first, count);
    const VectorXd measured = pair.measured.col(joint).segment(first, count);
    const double change = norm_about_mean(load);
    const double measured_change = norm_about_mean(measured);
    if (!(measured_change > 0)) return;
    if (!(change > kChanges * load.norm()) || !(change > kOfMeasured * measured_change)) return;
    lags[i] = estimate_lag(pair, joint, first, count, honest_s);
  });
  for (const auto& lag : lags) {
    if (!lag || lag->independence < kIndependent) continue;
    ++common.joints;
    low = std::min(low, lag->lag_s);
    high = std::max(high, lag->lag_s);
    common.lag_s += lag->lag_s;
    common.likelihood += lag->likelihood;
    inside = inside && !lag->at_end;
  }
  if (common.joints == 0) return common;
  common.lag_s /= common.joints;
  common.likelihood /= common.joints;
  common.agreed = inside && high - low <= std::max(kAgreeS, kAgreeShare * std::abs(common.lag_s));
  return common;
}

}  // namespace

void find_clock_skew(const Log& log, const TorquePair& pair, std::vector<DataFault>& faults) {
  // Log-likelihood that the lag must gain per joint: missing effects gain up to 4, a lag of 13 ms
  // in noise of 3 % of the torque limit 12.
  constexpr double kClear = 10;
  // A single joint cannot tell its own elasticity, which looks like up to 14 ms, from a clock.
  constexpr double kLoneJoint = 2;
  constexpr double kLoneJointClear = 30;
  const double honest_s = honest_lag(log.period_s);
  const Index half = pair.t_s.size() / 2;
  // More of it would say the same.
  constexpr double kLongestS = 600;
  const Index part =
      std::min<Index>(half, static_cast<Index>(std::floor(kLongestS / pair.period_s)));
  const Index apart = 2 * half - part;
  const CommonLag early = common_lag(pair, 0, part, honest_s);
  const CommonLag late = common_lag(pair, apart, part, honest_s);
  if (!early.agreed || !late.agreed) return;
  const bool lone = pair.q.cols() < 2;
  // Where the robot has several joints, one that moves alone has none to bear it out.
  if (!lone && std::min(early.joints, late.joints) < 2) return;
  const double least_s = lone ? kLoneJoint * honest_s : honest_s;
  const double least_likelihood = lone ? kLoneJointClear : kClear;
  const auto clear = [&](const CommonLag& at) {
    return std::abs(at.lag_s) > least_s && at.likelihood > least_likelihood;
  };
  if (!clear(early) && !clear(late)) return;
  DataFault fault;
  fault.kind = DataFaultKind::kClockSkew;
  fault.size = (early.lag_s + late.lag_s) / 2;
  fault.unit = "s";
  if (std::abs(late.lag_s - early.lag_s) > honest_s) {
    const double rate = (late.lag_s - early.lag_s) / (static_cast<double>(apart) * pair.period_s);
    fault.words = fmt::format(
        "torque and position run on two clocks: the torque is {:.1f} ms late in the first half and "
        "{:.1f} ms in the second, a drift of {:.2f} %",
        1e3 * early.lag_s, 1e3 * late.lag_s, 100 * rate);
    fault.mend = "stamp both channels with one clock, or rescale the time of one of them";
  } else {
    fault.words = fmt::format("the torque is {:.1f} ms {} against the positions",
                              1e3 * std::abs(fault.size), fault.size > 0 ? "late" : "early");
    fault.mend = fmt::format("shift the torque channel by {:.1f} ms, or mend the time stamps",
                             -1e3 * fault.size);
  }
  faults.push_back(std::move(fault));
}

}  // namespace offnominal::desk
