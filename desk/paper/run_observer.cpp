#include "paper/run_observer.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <offnominal/model/mass_matrix.hpp>

#include "common/nearer_filter.hpp"
#include "robot/chain_of.hpp"

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
  if (robot.estimator.space != EstimatorSpace::kTorque) return;
  model_ = make_model(chain_of<kRuntimeJoints, double>(robot));
  result_.has_two_levels = robot.bound->has_two_levels();
  for (const RobotJoint& joint : robot.joints) {
    const bool turns = joint.joint.type == JointType::kRevolute;
    JointRun& of_joint = result_.joints.emplace_back();
    of_joint.name = joint.name;
    of_joint.unit = turns ? "N m" : "N";
    const std::size_t i = result_.joints.size() - 1;
    of_joint.act_ratio = robot.bound->joints[i].act_ratio;
    if (!robot.bound->fast.empty()) of_joint.fast_act_ratio = robot.bound->fast[i].act_ratio;
  }
  for (auto* per_joint : {&series.joint_residual, &series.joint_threshold, &series.joint_fault}) {
    per_joint->resize(robot.joints.size());
  }
  if (robot.bound->fast.empty()) return;
  for (auto* per_joint : {&series.joint_fast_residual, &series.joint_fast_threshold}) {
    per_joint->resize(robot.joints.size());
  }
}

sim::JointVector RunObserver::fault_of(const TickRecord& tick) const {
  if (!model_) return tick.psi;
  return mass_matrix<kRuntimeJoints, double>(*model_, tick.state.q) * tick.psi;
}

void RunObserver::operator()(const TickRecord& tick) {
  // W_alpha over one tick, its input taken at the tick's mean value.
  const sim::JointVector psi = fault_of(tick);
  eta_ = decay_ * eta_ + input_gain_ * 0.5 * (last_psi_ + psi);
  last_psi_ = psi;
  judge(tick);
  if (tick.time_s >= window_start_ - tolerance_) add_to_window(tick, psi);
  if (settings_.record) keep(tick, psi);
}

ExperimentResult RunObserver::finish() {
  const auto ticks = static_cast<double>(window_.ticks);
  const auto rms = [&](double sum, bool any) {
    return any ? std::sqrt(sum / ticks) : std::numeric_limits<double>::quiet_NaN();
  };
  const auto slides = [](const RobotJoint& joint) {
    return joint.joint.type == JointType::kPrismatic;
  };
  const auto& joints = robot_.joints;
  result_.tracking_rms_rad =
      rms(window_.tracking_rad2, !std::all_of(joints.begin(), joints.end(), slides));
  if (std::any_of(joints.begin(), joints.end(), slides)) {
    result_.tracking_rms_m = rms(window_.tracking_m2, true);
  }
  if (window_.psi > 0.0) {
    result_.fault_estimate_relative_error = std::sqrt(window_.mismatch / window_.psi);
  }
  result_.accommodate = settings_.accommodate;
  result_.precision = settings_.precision;
  result_.seed = robot_.estimator.seed;
  return std::move(result_);
}

bool RunObserver::is_guaranteed(const TickRecord& tick) const {
  if (!model_) return eta_.norm() > 2.0 * tick.threshold;
  const double alpha = robot_.estimator.alpha;
  return (alpha * eta_.array().abs() > 2.0 * tick.thresholds.array()).any();
}

void RunObserver::judge(const TickRecord& tick) {
  result_.steps = tick.tick;
  result_.max_weight_norm = std::max(result_.max_weight_norm, tick.weight_norm);
  const auto note = [&](bool is_so, std::optional<double>& since_s) {
    if (is_so && !since_s) since_s = tick.time_s;
  };
  note(tick.detected, result_.detection_time_s);
  note(tick.acts, result_.act_time_s);
  note(tick.slows, result_.slowed_time_s);
  if (!result_.guaranteed_time_s && is_guaranteed(tick)) result_.guaranteed_time_s = tick.time_s;
  const bool healthy = tick.time_s <= healthy_until_ + tolerance_;
  if (model_) judge_joints(tick, healthy);
  if (healthy) {
    double& ratio = result_.max_error_to_threshold_before_fault;
    ratio = std::max(ratio, tick.error_norm / tick.threshold);
    double& largest = result_.max_abs_psi_hat_before_fault;
    largest = std::max(largest, tick.psi_hat.lpNorm<Eigen::Infinity>());
  }
}

bool RunObserver::acts(const TickRecord& tick, std::size_t joint) const {
  const auto index = static_cast<Eigen::Index>(joint);
  const JointRun& of_joint = result_.joints[joint];
  const auto is_beyond = [&](const sim::JointVector& error, const sim::JointVector& thresholds,
                             double act_ratio) {
    return error.size() > 0 && std::abs(error[index]) > act_ratio * thresholds[index];
  };
  return is_beyond(tick.error, tick.thresholds, of_joint.act_ratio) ||
         is_beyond(tick.fast_error, tick.fast_thresholds, of_joint.fast_act_ratio);
}

void RunObserver::judge_joints(const TickRecord& tick, bool healthy) {
  for (std::size_t i = 0; i < result_.joints.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    const ResidualAgainst nearest =
        nearer_filter(tick.error, tick.thresholds, tick.fast_error, tick.fast_thresholds, index);
    JointRun& joint = result_.joints[i];
    if (nearest.residual > nearest.threshold && !joint.detection_time_s)
      joint.detection_time_s = tick.time_s;
    if (!joint.act_time_s && acts(tick, i)) joint.act_time_s = tick.time_s;
    if (!healthy || nearest.threshold <= 0) continue;
    double& ratio = joint.max_error_to_threshold_before_fault;
    ratio = std::max(ratio, nearest.residual / nearest.threshold);
  }
  if (tick.first_joint < 0 || result_.first_joint) return;
  result_.first_joint = tick.first_joint;
  // Of a position to which no motion comes no residual tells.
  JointRun& first = result_.joints[static_cast<std::size_t>(tick.first_joint)];
  if (!first.detection_time_s) first.detection_time_s = tick.time_s;
  if (tick.acts && !first.act_time_s && *first.detection_time_s == tick.time_s) {
    first.act_time_s = tick.time_s;
  }
}

void RunObserver::add_to_window(const TickRecord& tick, const sim::JointVector& psi) {
  ++window_.ticks;
  const sim::JointVector off = tick.q_desired - tick.state.q;
  double rad2 = 0;
  double m2 = 0;
  for (std::size_t i = 0; i < robot_.joints.size(); ++i) {
    const bool turns = robot_.joints[i].joint.type == JointType::kRevolute;
    const double error = off[static_cast<Eigen::Index>(i)];
    (turns ? rad2 : m2) += error * error;
  }
  window_.tracking_rad2 += rad2;
  window_.tracking_m2 += m2;
  window_.psi += psi.squaredNorm();
  window_.mismatch += (psi - tick.psi_hat).squaredNorm();
}

void RunObserver::keep_joints(const TickRecord& tick) {
  TimeSeries& series = result_.series;
  for (std::size_t i = 0; i < result_.joints.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    series.joint_residual[i].push_back(std::abs(tick.error[index]));
    series.joint_threshold[i].push_back(tick.thresholds[index]);
    series.joint_fault[i].push_back(robot_.estimator.alpha * std::abs(eta_[index]));
    if (series.joint_fast_residual.empty()) continue;
    series.joint_fast_residual[i].push_back(std::abs(tick.fast_error[index]));
    series.joint_fast_threshold[i].push_back(tick.fast_thresholds[index]);
  }
}

void RunObserver::keep(const TickRecord& tick, const sim::JointVector& psi) {
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
  keep_all(series.psi, psi);
  keep_all(series.psi_hat, tick.psi_hat);
  series.error_norm.push_back(tick.error_norm);
  series.threshold.push_back(tick.threshold);
  series.filtered_fault.push_back(eta_.norm());
  if (model_) keep_joints(tick);
  if (tick.bus) series.bus.push_back(*tick.bus);
}

}  // namespace offnominal::desk::paper
