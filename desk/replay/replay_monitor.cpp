#include "replay/replay_monitor.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <offnominal/monitor.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "common/error.hpp"
#include "robot/monitor_config_of.hpp"

namespace offnominal::desk {
namespace {

template <typename Space>
using ReplayMonitor = Monitor<kRuntimeJoints, kReplayCapacity, double, WithMemory, Space>;

void require_start(Status status, const RobotDescription& robot) {
  if (status == Status::kOk) return;
  throw InputError({.file = "robot " + robot.name,
                    .place = "monitor",
                    .found = std::string("status ") + name_of(status),
                    .allowed = "",
                    .mend = "docs/troubleshooting.md says what each status asks for"});
}

double ratio_of(double error, double threshold) {
  if (threshold > 0) return error / threshold;
  return error > 0 ? std::numeric_limits<double>::infinity() : 0.0;
}

// Joins samples with an alarm to stretches.
class AlarmCollector {
 public:
  void take(double t_s, bool level, double ratio, std::vector<Alarm>& alarms,
            std::optional<double>& detection_time_s) {
    if (level) {
      if (!in_alarm_) alarms.push_back({t_s, t_s, 0});
      Alarm& alarm = alarms.back();
      alarm.end_s = t_s;
      alarm.max_error_to_threshold = std::max(alarm.max_error_to_threshold, ratio);
      if (!detection_time_s) detection_time_s = t_s;
    }
    in_alarm_ = level;
  }

 private:
  bool in_alarm_ = false;
};

// Collects what the monitor says of one accepted sample after the other.
class ReplayCollector {
 public:
  ReplayCollector(Eigen::Index samples, int joints, Replay& result)
      : result_(result), joints_(result.joints.size()) {
    if (!result.joints.empty()) result.thresholds.resize(samples, joints);
    result.t_s.resize(samples);
    result.error.resize(samples, joints);
    result.error_norm.resize(samples);
    result.threshold.resize(samples);
    result.psi_hat.resize(samples, joints);
  }

  template <typename Space>
  void accept(double t_s, const MonitorOutput<kRuntimeJoints, double, Space>& output,
              double weight_norm) {
    if constexpr (std::is_same_v<Space, TorqueSpace>) accept_joints(t_s, output);
    result_.t_s[count_] = t_s;
    result_.error.row(count_) = output.error.transpose();
    result_.error_norm[count_] = output.error_norm;
    result_.threshold[count_] = output.threshold;
    result_.psi_hat.row(count_) = output.psi_hat.transpose();
    ++count_;
    refused_in_a_row_ = 0;
    const double ratio = ratio_of(output.error_norm, output.threshold);
    result_.max_error_to_threshold = std::max(result_.max_error_to_threshold, ratio);
    result_.max_weight_norm = std::max(result_.max_weight_norm, weight_norm);
    any_.take(t_s, output.detector.level, ratio, result_.alarms, result_.detection_time_s);
  }

  void refuse(double t_s, Status status) {
    Refusals& refusals = result_.refused[name_of(status)];
    if (refusals.count++ == 0) refusals.first_s = t_s;
    result_.longest_refused = std::max(result_.longest_refused, ++refused_in_a_row_);
  }

  void finish() {
    result_.t_s.conservativeResize(count_);
    result_.error.conservativeResize(count_, Eigen::NoChange);
    result_.error_norm.conservativeResize(count_);
    result_.threshold.conservativeResize(count_);
    result_.psi_hat.conservativeResize(count_, Eigen::NoChange);
    if (!result_.joints.empty()) result_.thresholds.conservativeResize(count_, Eigen::NoChange);
  }

 private:
  void accept_joints(double t_s, const MonitorOutput<kRuntimeJoints, double, TorqueSpace>& output) {
    result_.thresholds.row(count_) = output.thresholds.transpose();
    if (output.detector.latched && !result_.first_joint) {
      result_.first_joint = output.detector.first_joint;
    }
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const auto index = static_cast<Eigen::Index>(i);
      const double residual = std::abs(output.error[index]);
      const double threshold = output.thresholds[index];
      const double ratio = ratio_of(residual, threshold);
      JointReplay& joint = result_.joints[i];
      joint.max_residual = std::max(joint.max_residual, residual);
      joint.max_threshold = std::max(joint.max_threshold, threshold);
      joint.max_error_to_threshold = std::max(joint.max_error_to_threshold, ratio);
      joints_[i].take(t_s, output.detector.joints[i].level, ratio, joint.alarms,
                      joint.detection_time_s);
    }
  }

  Replay& result_;
  Eigen::Index count_ = 0;
  std::int64_t refused_in_a_row_ = 0;
  AlarmCollector any_;
  std::vector<AlarmCollector> joints_;
};

// Of the sample that a run starts with: no error yet.
template <typename Space>
MonitorOutput<kRuntimeJoints, double, Space> first_output(std::size_t joints) {
  MonitorOutput<kRuntimeJoints, double, Space> output;
  size_for(joints, output.error, output.psi_hat);
  if constexpr (std::is_same_v<Space, TorqueSpace>) {
    size_for(joints, output.thresholds, output.detector.joints);
  }
  return output;
}

template <typename Space>
void replay_in(const RobotDescription& robot, const Log& log, Replay& result) {
  using Watch = ReplayMonitor<Space>;
  auto config = monitor_config_of<kRuntimeJoints, double, Space>(robot);
  config.estimator.period_s = log.period_s;
  Watch monitor;
  require_start(Watch::create(config, monitor), robot);
  // On the heap: 128 hidden units of 12 joints do not belong on a stack.
  const auto state = std::make_unique<typename Watch::State>();
  auto output = first_output<Space>(robot.joints.size());

  ReplayCollector collector(log.sample_count(), robot.joint_count(), result);
  bool started = false;
  for (Eigen::Index i = 0; i < log.sample_count(); ++i) {
    const typename Watch::Sample sample{log.q.row(i).transpose(), log.dq.row(i).transpose(),
                                        log.tau.row(i).transpose()};
    const Status status =
        started ? monitor.step(sample, *state, output) : monitor.reset(sample, *state);
    // A run starts at the first sample that is good; a setting that no sample can mend ends it.
    if (status == Status::kInvalidInitialWeights) require_start(status, robot);
    if (status != Status::kOk) {
      collector.refuse(log.t_s[i], status);
      continue;
    }
    started = true;
    collector.accept<Space>(log.t_s[i], output, std::sqrt(state->estimator.theta_squared_norm));
  }
  collector.finish();
}

}  // namespace

void replay_monitor(const RobotDescription& robot, const Log& log, Replay& result) {
  if (robot.estimator.space == EstimatorSpace::kTorque) {
    replay_in<TorqueSpace>(robot, log, result);
  } else {
    replay_in<AccelerationSpace>(robot, log, result);
  }
}

}  // namespace offnominal::desk
