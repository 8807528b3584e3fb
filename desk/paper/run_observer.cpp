#include "paper/run_observer.hpp"

#include <algorithm>
#include <cmath>

namespace offnominal::desk::paper {

RunObserver::RunObserver(const RobotDescription& robot, const RunSettings& settings,
                         double fault_time_s)
    : robot_(robot),
      settings_(settings),
      decay_(std::exp(-robot.estimator.alpha * robot.estimator.period_s)),
      input_gain_(-std::expm1(-robot.estimator.alpha * robot.estimator.period_s) /
                  robot.estimator.alpha),
      healthy_until_(std::min(fault_time_s, settings.duration_s)),
      window_start_(0.75 * settings.duration_s),
      tolerance_(1e-6 * robot.estimator.period_s),
      eta_(sim::JointVector::Zero(robot.joint_count())),
      last_psi_(eta_) {
  TimeSeries& series = result_.series;
  for (auto* per_joint :
       {&series.q, &series.dq, &series.tau, &series.q_desired, &series.psi, &series.psi_hat}) {
    per_joint->resize(robot.joints.size());
  }
}

void RunObserver::operator()(const TickRecord& tick) {
  // W_alpha over one tick, its input taken at the tick's mean value.
  eta_ = decay_ * eta_ + input_gain_ * 0.5 * (last_psi_ + tick.psi);
  last_psi_ = tick.psi;
  judge(tick);
  if (tick.time_s >= window_start_ - tolerance_) add_to_window(tick);
  if (settings_.record) keep(tick);
}

ExperimentResult RunObserver::finish() {
  const auto ticks = static_cast<double>(window_.ticks);
  result_.tracking_rms_rad = std::sqrt(window_.tracking / ticks);
  if (window_.psi > 0.0) {
    result_.fault_estimate_relative_error = std::sqrt(window_.mismatch / window_.psi);
  }
  result_.accommodate = settings_.accommodate;
  result_.precision = settings_.precision;
  result_.seed = robot_.estimator.seed;
  return std::move(result_);
}

void RunObserver::judge(const TickRecord& tick) {
  result_.steps = tick.tick;
  result_.max_weight_norm = std::max(result_.max_weight_norm, tick.weight_norm);
  if (tick.detected && !result_.detection_time_s) result_.detection_time_s = tick.time_s;
  if (eta_.norm() > 2.0 * tick.threshold && !result_.guaranteed_time_s) {
    result_.guaranteed_time_s = tick.time_s;
  }
  if (tick.time_s <= healthy_until_ + tolerance_) {
    double& ratio = result_.max_error_to_threshold_before_fault;
    ratio = std::max(ratio, tick.error_norm / tick.threshold);
    double& largest = result_.max_abs_psi_hat_before_fault;
    largest = std::max(largest, tick.psi_hat.lpNorm<Eigen::Infinity>());
  }
}

void RunObserver::add_to_window(const TickRecord& tick) {
  ++window_.ticks;
  window_.tracking += (tick.q_desired - tick.state.q).squaredNorm();
  window_.psi += tick.psi.squaredNorm();
  window_.mismatch += (tick.psi - tick.psi_hat).squaredNorm();
}

void RunObserver::keep(const TickRecord& tick) {
  TimeSeries& series = result_.series;
  series.time_s.push_back(tick.time_s);
  const auto keep_all = [](std::vector<std::vector<double>>& series_of,
                           const sim::JointVector& values) {
    for (std::size_t j = 0; j < series_of.size(); ++j) {
      series_of[j].push_back(values[static_cast<Eigen::Index>(j)]);
    }
  };
  keep_all(series.q, tick.state.q);
  keep_all(series.dq, tick.state.dq);
  keep_all(series.tau, tick.tau);
  keep_all(series.q_desired, tick.q_desired);
  keep_all(series.psi, tick.psi);
  keep_all(series.psi_hat, tick.psi_hat);
  series.error_norm.push_back(tick.error_norm);
  series.threshold.push_back(tick.threshold);
  series.filtered_fault.push_back(eta_.norm());
  if (tick.bus) series.bus.push_back(*tick.bus);
}

}  // namespace offnominal::desk::paper
