#include "replay/replay_monitor.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <offnominal/monitor.hpp>
#include <string>

#include "common/error.hpp"
#include "robot/monitor_config_of.hpp"

namespace offnominal::desk {
namespace {

using ReplayMonitor = Monitor<kRuntimeJoints, kReplayCapacity, double, WithMemory>;

void require_start(Status status, const RobotDescription& robot) {
  if (status == Status::kOk) return;
  throw InputError({.file = "robot " + robot.name,
                    .place = "monitor",
                    .found = std::string("status ") + name_of(status),
                    .allowed = "",
                    .mend = "docs/troubleshooting.md says what each status asks for"});
}

// Collects what the monitor says of one accepted sample after the other.
class ReplayCollector {
 public:
  ReplayCollector(Eigen::Index samples, int joints, Replay& result) : result_(result) {
    result.t_s.resize(samples);
    result.error.resize(samples, joints);
    result.error_norm.resize(samples);
    result.threshold.resize(samples);
    result.psi_hat.resize(samples, joints);
  }

  void accept(double t_s, const ReplayMonitor::Output& output, double weight_norm) {
    result_.t_s[count_] = t_s;
    result_.error.row(count_) = output.error.transpose();
    result_.error_norm[count_] = output.error_norm;
    result_.threshold[count_] = output.threshold;
    result_.psi_hat.row(count_) = output.psi_hat.transpose();
    ++count_;
    refused_in_a_row_ = 0;
    const double ratio = output.threshold > 0    ? output.error_norm / output.threshold
                         : output.error_norm > 0 ? std::numeric_limits<double>::infinity()
                                                 : 0.0;
    result_.max_error_to_threshold = std::max(result_.max_error_to_threshold, ratio);
    result_.max_weight_norm = std::max(result_.max_weight_norm, weight_norm);
    if (output.detector.level) {
      if (!in_alarm_) result_.alarms.push_back({t_s, t_s, 0});
      Alarm& alarm = result_.alarms.back();
      alarm.end_s = t_s;
      alarm.max_error_to_threshold = std::max(alarm.max_error_to_threshold, ratio);
      if (!result_.detection_time_s) result_.detection_time_s = t_s;
    }
    in_alarm_ = output.detector.level;
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
  }

 private:
  Replay& result_;
  Eigen::Index count_ = 0;
  std::int64_t refused_in_a_row_ = 0;
  bool in_alarm_ = false;
};

}  // namespace

void replay_monitor(const RobotDescription& robot, const Log& log, Replay& result) {
  auto config = monitor_config_of<kRuntimeJoints, double>(robot);
  config.estimator.period_s = log.period_s;
  ReplayMonitor monitor;
  require_start(ReplayMonitor::create(config, monitor), robot);
  // On the heap: 128 hidden units of 12 joints do not belong on a stack.
  const auto state = std::make_unique<ReplayMonitor::State>();
  ReplayMonitor::Output output;
  // Of the sample that a run starts with: no error yet.
  size_for(robot.joints.size(), output.error, output.psi_hat);
  ReplayCollector collector(log.sample_count(), robot.joint_count(), result);
  bool started = false;
  for (Eigen::Index i = 0; i < log.sample_count(); ++i) {
    const ReplayMonitor::Sample sample{log.q.row(i).transpose(), log.dq.row(i).transpose(),
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
    collector.accept(log.t_s[i], output, std::sqrt(state->estimator.theta_squared_norm));
  }
  collector.finish();
}

}  // namespace offnominal::desk
