#include "replay/replay_monitor.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <offnominal/diagnosis/isolation.hpp>
#include <offnominal/model/effect_list.hpp>
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
      if (!in_alarm_) alarms.push_back({t_s, t_s, 0, {}});
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
    end_refusals(t_s);
    const double ratio = ratio_of(output.error_norm, output.threshold);
    result_.max_error_to_threshold = std::max(result_.max_error_to_threshold, ratio);
    result_.max_weight_norm = std::max(result_.max_weight_norm, weight_norm);
    any_.take(t_s, output.detector.level, ratio, result_.alarms, result_.detection_time_s);
    if constexpr (std::is_same_v<Space, TorqueSpace>) {
      if (output.detector.level) name_joints(output);
    }
  }

  void refuse(double t_s, Status status) {
    Refusals& refusals = result_.refused[name_of(status)];
    if (refusals.count++ == 0) refusals.first_s = t_s;
    if (refused_in_a_row_++ == 0) first_refused_s_ = t_s;
    last_refused_s_ = t_s;
    result_.longest_refused = std::max(result_.longest_refused, refused_in_a_row_);
  }

  [[nodiscard]] std::int64_t refused_in_a_row() const { return refused_in_a_row_; }

  void finish() {
    end_refusals(last_refused_s_);
    result_.t_s.conservativeResize(count_);
    result_.error.conservativeResize(count_, Eigen::NoChange);
    result_.error_norm.conservativeResize(count_);
    result_.threshold.conservativeResize(count_);
    result_.psi_hat.conservativeResize(count_, Eigen::NoChange);
    if (!result_.joints.empty()) result_.thresholds.conservativeResize(count_, Eigen::NoChange);
  }

 private:
  void end_refusals(double t_s) {
    if (refused_in_a_row_ > kBorneInARow) {
      result_.blind.push_back({first_refused_s_, t_s, refused_in_a_row_});
    }
    refused_in_a_row_ = 0;
  }

  // Of the stretch that is under way: who has crossed now, and had not before.
  void name_joints(const MonitorOutput<kRuntimeJoints, double, TorqueSpace>& output) {
    std::vector<int>& named = result_.alarms.back().joints;
    const auto ratio = [&](int joint) {
      return ratio_of(std::abs(output.error[joint]), output.thresholds[joint]);
    };
    const auto before = static_cast<std::ptrdiff_t>(named.size());
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const int joint = static_cast<int>(i);
      const bool is_named = std::find(named.begin(), named.end(), joint) != named.end();
      if (output.detector.joints[i].level && !is_named) named.push_back(joint);
    }
    std::stable_sort(named.begin() + before, named.end(),
                     [&](int a, int b) { return ratio(a) > ratio(b); });
  }

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
  double first_refused_s_ = 0;  // of those in a row
  double last_refused_s_ = 0;
  AlarmCollector any_;
  std::vector<AlarmCollector> joints_;
};

// Asks after a detection which fault it is: in torque space, where each joint speaks for itself.
template <typename Space>
class FaultNamer {
 public:
  FaultNamer(const MonitorConfig<kRuntimeJoints, double, Space>& /*config*/, Replay& /*result*/) {}
  void begin_afresh() {}
  template <typename Watch>
  void take(const Watch& /*monitor*/, const typename Watch::State& /*state*/,
            const typename Watch::Output& /*output*/, double /*t_s*/) {}
  void finish() {}
};
template <>
class FaultNamer<TorqueSpace> {
 public:
  FaultNamer(const MonitorConfig<kRuntimeJoints, double, TorqueSpace>& config, Replay& result)
      : result_(result), state_(std::make_unique<IsolationState<kRuntimeJoints, double>>()) {
    for (const Joint<double>& joint : config.chain.joints) types_.push_back(joint.type);
    // Defaults, which are valid.
    static_cast<void>(Isolation<kRuntimeJoints, double>::create({}, config, isolation_));
    isolation_.reset(*state_);
  }
  void begin_afresh() {
    finish();
    isolation_.reset(*state_);
  }
  template <typename Watch>
  void take(const Watch& monitor, const typename Watch::State& state,
            const typename Watch::Output& output, double t_s) {
    if (!state_->triggered && output.detector.latched) detection_s_ = t_s;
    isolation_.step(monitor.model(), state.sample, state.tick, output, *state_);
    if (state_->diagnosis.time_s != answer_at_) answer_s_ = t_s;
    answer_at_ = state_->diagnosis.time_s;
  }
  // An answer that has not been decided yet is the best that there is.
  void finish() {
    const FaultDiagnosis<double>& said = state_->diagnosis;
    if (!state_->triggered || said.time_s <= 0) return;
    result_.faults.push_back({said.kind, said.joint, said.size, said.deviation,
                              size_unit_of(said.kind, types_[said.joint]), said.confidence,
                              said.unexplained, detection_s_, answer_s_, said.decided});
  }

 private:
  Replay& result_;
  Isolation<kRuntimeJoints, double> isolation_;
  std::unique_ptr<IsolationState<kRuntimeJoints, double>> state_;
  std::vector<JointType> types_;
  double detection_s_ = 0;  // times of the recording
  double answer_s_ = 0;
  double answer_at_ = 0;  // time of the run
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

bool counts_time(const RobotDescription& robot) {
  return std::any_of(robot.effects.begin(), robot.effects.end(), [](const RobotEffect& effect) {
    return info_of(effect.kind)->traits.counts_time;
  });
}

// Begins as at the start of a recording, with two differences. The time that effects count goes on:
// `tick` is what the recording has come to. And a threshold that was there stays: one that begins
// at nothing is that of the bound at an instant, which a healthy robot may exceed for as long as
// the filter forgives it (docs/theory.md, erratum 6).
template <typename Watch>
Status begin_afresh(const Watch& monitor, const typename Watch::Sample& sample, std::uint64_t tick,
                    bool counts_time, typename Watch::State& state) {
  const auto before = state.initialised ? std::optional(state.estimator.mu) : std::nullopt;
  Status status = monitor.reset(sample, state);
  if (status != Status::kOk) return status;
  const auto threshold = before.value_or(state.estimator.mu);
  if (counts_time && tick > 0) {
    state.tick = tick - 1;
    status = monitor.resume(sample, 0, state);
  }
  state.estimator.mu = threshold;
  return status;
}

// What is said of the sample that it begins afresh with: no error yet, and the threshold that was.
template <typename Output>
void forget(const Output& at_start, Output& output) {
  output.error = at_start.error;
  output.error_norm = at_start.error_norm;
  output.psi_hat = at_start.psi_hat;
  output.detector = at_start.detector;
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
  const auto at_start = first_output<Space>(robot.joints.size());
  auto output = at_start;

  ReplayCollector collector(log.sample_count(), robot.joint_count(), result);
  FaultNamer<Space> namer(config, result);
  const bool in_time = counts_time(robot);
  for (Eigen::Index i = 0; i < log.sample_count(); ++i) {
    const typename Watch::Sample sample{log.q.row(i).transpose(), log.dq.row(i).transpose(),
                                        log.tau.row(i).transpose()};
    const std::int64_t missed = collector.refused_in_a_row();
    // A run starts at the first sample that is good.
    const bool afresh = !state->initialised || missed > kBorneInARow;
    Status status = Status::kOk;
    if (afresh) {
      status = begin_afresh(monitor, sample, static_cast<std::uint64_t>(i), in_time, *state);
    } else if (missed > 0) {
      status = monitor.resume(sample, static_cast<std::uint32_t>(missed), *state);
    } else {
      status = monitor.step(sample, *state, output);
    }
    // A setting that no sample can mend ends it.
    if (status == Status::kInvalidInitialWeights) require_start(status, robot);
    if (status != Status::kOk) {
      collector.refuse(log.t_s[i], status);
      continue;
    }
    if (afresh) {
      forget(at_start, output);
      namer.begin_afresh();
    } else if (missed == 0) {
      namer.take(monitor, *state, output, log.t_s[i]);
    }
    collector.accept<Space>(log.t_s[i], output, std::sqrt(state->estimator.theta_squared_norm));
  }
  collector.finish();
  namer.finish();
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
