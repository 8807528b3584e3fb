#include "log/sampling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/error.hpp"
#include "log/read_log.hpp"
#include "signal/differentiate.hpp"
#include "signal/fold.hpp"
#include "signal/resample.hpp"
#include "signal/zero_phase.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// A spline through the jump of an angle that is folded into a turn would swing beyond both ends.
VectorXd position_at(const VectorXd& t_s, const VectorXd& q, const VectorXd& at_s) {
  for (const double turn : {2 * std::numbers::pi, 360.0}) {
    const std::vector<Index> folds = folds_of(q, turn);
    if (folds.empty()) continue;
    VectorXd whole = q;
    unfold(whole, turn, folds);
    const double low = (q.minCoeff() + q.maxCoeff() - turn) / 2;
    VectorXd result = spline_at(t_s, whole, at_s);
    for (double& angle : result) angle -= turn * std::floor((angle - low) / turn);
    return result;
  }
  return spline_at(t_s, q, at_s);
}

void resample(Log& log, double period_s) {
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
    }
    columns = std::move(result);
  };
  resample_columns(log.q, position_at);
  resample_columns(log.dq, linear_at);
  resample_columns(log.tau, linear_at);
  if (log.sensor_tau.rows() > 0) resample_columns(log.sensor_tau, linear_at);
  for (auto& [name, values] : log.extra) values = linear_at(recorded, values, even);
  log.t_s = std::move(even);
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
  const Sampling sampling = sampling_of(log.t_s);
  if (sampling.jitter <= kSamplingJitter) {
    log.period_s = sampling.mean_period_s;
    return;
  }
  const double period_s = sampling.median_period_s;
  if (sampling.largest_gap_s > kMaxGap * period_s) {
    throw InputError({log.file, fmt::format("t = {:.6g} s", sampling.largest_gap_at_s),
                      fmt::format("a gap of {:.4g} s", sampling.largest_gap_s),
                      fmt::format("gaps up to {:g} sampling periods, {:.4g} s here", kMaxGap,
                                  kMaxGap * period_s),
                      "cut the recording at the gap"});
  }
  log.remarks.push_back(fmt::format(
      "sampling is not even (steps of {:.4g} s, off by up to {:.0f} % of their mean): resampled to "
      "{:.4g} s",
      period_s, 100 * sampling.jitter, period_s));
  resample(log, period_s);
  log.period_s = period_s;
}

void derive_velocities(Log& log) {
  const double rate_hz = log.sample_rate_hz();
  const double cutoff_hz = std::min(100.0, rate_hz / 5);
  for (Index joint = 0; joint < log.q.cols(); ++joint) {
    if (!log.dq_derived[static_cast<std::size_t>(joint)]) continue;
    const VectorXd smooth = zero_phase_low_pass(log.q.col(joint), cutoff_hz, rate_hz);
    log.dq.col(joint) = central_difference(smooth, log.period_s);
  }
}

}  // namespace offnominal::desk
