#include "replay/watch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <offnominal/diagnosis/isolation.hpp>
#include <offnominal/model/effect_list.hpp>
#include <offnominal/monitor.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/error.hpp"
#include "replay/replay_monitor.hpp"
#include "robot/monitor_config_of.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {
namespace {

// `L`: the most hidden units.
template <typename Space, int L>
using ReplayMonitor = Monitor<kRuntimeJoints, L, double, WithMemory, Space>;

void require_start(Status status, const RobotDescription& robot) {
  if (status == Status::kOk) return;
  throw InputError({.file = "robot " + robot.name,
                    .place = "monitor",
                    .found = std::string("status ") + name_of(status),
                    .allowed = "",
                    .mend = "docs/troubleshooting.md says what each status asks for"});
}

// Asks after a detection which fault it is: in torque space, where each joint speaks for itself.
template <typename Space>
class FaultNamer {
 public:
  FaultNamer(const MonitorConfig<kRuntimeJoints, double, Space>& /*config*/,
             const Watch::OnFault& /*on_fault*/) {}
  void begin_afresh() {}
  template <typename Monitored>
  void take(const Monitored& /*monitor*/, const typename Monitored::State& /*state*/,
            const Vector<kRuntimeJoints, double>& /*readings*/,
            typename Monitored::Output& /*output*/, double /*t_s*/) {}
  void finish() {}
  [[nodiscard]] static std::optional<IsolatedFault> answer() { return std::nullopt; }
};
template <>
class FaultNamer<TorqueSpace> {
 public:
  FaultNamer(const MonitorConfig<kRuntimeJoints, double, TorqueSpace>& config,
             Watch::OnFault on_fault)
      : on_fault_(std::move(on_fault)),
        state_(std::make_unique<IsolationState<kRuntimeJoints, double>>()) {
    for (const Joint<double>& joint : config.chain.joints) types_.push_back(joint.type);
    // Defaults, which are valid.
    static_cast<void>(Isolation<kRuntimeJoints, double>::create({}, config, isolation_));
    isolation_.reset(*state_);
  }
  void begin_afresh() {
    finish();
    isolation_.reset(*state_);
  }
  // The compensation is then the named fault's own, as on a controller.
  template <typename Monitored>
  void take(const Monitored& monitor, const typename Monitored::State& state,
            const Vector<kRuntimeJoints, double>& readings, typename Monitored::Output& output,
            double t_s) {
    const bool is_new =
        !state_->triggered || state_->detection_tick != output.detector.detection_tick;
    if (is_new && output.detector.latched) detection_s_ = t_s;
    const auto& sample = state.sample;
    isolation_.step(monitor.model(), sample, readings.size() > 0 ? readings : sample.q,
                    joint_transforms(monitor.model(), sample.q), state.tick, output, *state_);
    const FaultLaw<kRuntimeJoints, double>& law = state_->law;
    if (law.known) output.compensation = monitor.compensation_of(law.load, output);
    if (state_->diagnosis.time_s != answer_at_) answer_s_ = t_s;
    answer_at_ = state_->diagnosis.time_s;
  }
  // An answer that has not been decided yet is the best that there is.
  void finish() {
    const std::optional<IsolatedFault> last = answer();
    if (last && on_fault_) on_fault_(*last);
  }
  [[nodiscard]] const FaultDiagnosis<double>& said() const { return state_->diagnosis; }
  [[nodiscard]] std::optional<IsolatedFault> answer() const {
    const FaultDiagnosis<double>& said = state_->diagnosis;
    if (!state_->triggered || said.time_s <= 0) return std::nullopt;
    return isolated_fault_of(said, types_, detection_s_, answer_s_);
  }

 private:
  Watch::OnFault on_fault_;
  Isolation<kRuntimeJoints, double> isolation_;
  std::unique_ptr<IsolationState<kRuntimeJoints, double>> state_;
  std::vector<JointType> types_;
  double detection_s_ = 0;  // times of the samples
  double answer_s_ = 0;
  double answer_at_ = 0;  // time of the run
};

// Of the sample that a run starts with: no error yet.
template <typename Space>
MonitorOutput<kRuntimeJoints, double, Space> first_output(std::size_t joints, bool has_fast) {
  MonitorOutput<kRuntimeJoints, double, Space> output;
  size_for(joints, output.error, output.psi_hat, output.compensation.torque);
  if constexpr (std::is_same_v<Space, TorqueSpace>) {
    size_for(joints, output.thresholds, output.detector.joints);
    if (has_fast) size_for(joints, output.fast_error, output.fast_thresholds);
  }
  return output;
}

bool counts_time(const RobotDescription& robot) {
  return std::any_of(robot.effects.begin(), robot.effects.end(), [](const RobotEffect& effect) {
    return info_of(effect.kind)->traits.counts_time;
  });
}

template <typename Space, int L>
class WatchOf final : public Watch {
 public:
  WatchOf(const RobotDescription& robot, double period_s, const OnFault& on_fault,
          Detections detections)
      : robot_(robot),
        detections_(detections),
        counts_time_(counts_time(robot)),
        config_(config_of(robot, period_s)),
        at_start_(first_output<Space>(robot.joints.size(), robot.estimator.fast_alpha > 0)),
        output_(at_start_),
        namer_(config_, on_fault) {
    require_start(Monitored::create(config_, monitor_), robot);
  }

  Status take(const Sample& now, double t_s, std::uint32_t missing) override {
    const JointSample<kRuntimeJoints, double>& sample = now.joints;
    missed_ += missing;
    ticks_ += missing;
    const std::uint64_t tick = ticks_++;
    // A run starts at the first sample that is good.
    const bool afresh = !state_->initialised || missed_ > kBorneInARow;
    Status status = Status::kOk;
    if (afresh) {
      status = begin_afresh(sample, tick);
    } else if (missed_ > 0) {
      status = monitor_.resume(sample, static_cast<std::uint32_t>(missed_), *state_);
    } else {
      status = monitor_.step(sample, *state_, output_);
    }
    // A setting that no sample can mend ends it.
    if (status == Status::kInvalidInitialWeights) require_start(status, robot_);
    if (status != Status::kOk) {
      ++missed_;
      return status;
    }
    if (afresh) {
      forget();
      namer_.begin_afresh();
      quiet_ticks_ = 0;
    } else if (missed_ == 0) {
      namer_.take(monitor_, *state_, now.readings, output_, t_s);
      if constexpr (std::is_same_v<Space, TorqueSpace>) {
        if (detections_ == Detections::kEach) arm_again();
      }
    }
    missed_ = 0;
    say();
    return status;
  }

  [[nodiscard]] const Watched& said() const override { return said_; }
  [[nodiscard]] std::optional<IsolatedFault> answer() const override { return namer_.answer(); }
  void finish() override { namer_.finish(); }

 private:
  using Monitored = ReplayMonitor<Space, L>;
  using Output = MonitorOutput<kRuntimeJoints, double, Space>;

  // Of both filters, where there are two.
  using State = typename Monitored::State;
  struct Thresholds {
    typename Space::template Threshold<kRuntimeJoints, double> slow;
    Vector<kRuntimeJoints, double> fast;
  };
  static Thresholds thresholds_of(const State& state) {
    Thresholds thresholds{state.estimator.mu, {}};
    if constexpr (std::is_same_v<Space, TorqueSpace>) thresholds.fast = state.fast.mu;
    return thresholds;
  }
  static void set_thresholds(const Thresholds& thresholds, State& state) {
    state.estimator.mu = thresholds.slow;
    if constexpr (std::is_same_v<Space, TorqueSpace>) state.fast.mu = thresholds.fast;
  }

  static MonitorConfig<kRuntimeJoints, double, Space> config_of(const RobotDescription& robot,
                                                                double period_s) {
    auto config = monitor_config_of<kRuntimeJoints, double, Space>(robot);
    config.estimator.period_s = period_s;
    return config;
  }

  // Begins as at the start of a recording, with two differences. The time that effects count goes
  // on: `tick` is what the samples have come to. And a threshold that was there stays: one that
  // begins at nothing is that of the bound at an instant, which a healthy robot may exceed for as
  // long as the filter forgives it (docs/theory.md, erratum 6).
  Status begin_afresh(const JointSample<kRuntimeJoints, double>& sample, std::uint64_t tick) {
    const bool had_begun = state_->initialised;
    Thresholds threshold = thresholds_of(*state_);
    Status status = monitor_.reset(sample, *state_);
    if (status != Status::kOk) return status;
    if (!had_begun) threshold = thresholds_of(*state_);
    if (counts_time_ && tick > 0) {
      state_->tick = tick - 1;
      status = monitor_.resume(sample, 0, *state_);
    }
    set_thresholds(threshold, *state_);
    return status;
  }

  // Of a fault that was named: after so long without an alarm, or where another joint has its first
  // long after, which a fault of one joint alone does not touch, the detection is taken back, as an
  // operator does, and what comes then is named by itself.
  void arm_again() {
    constexpr double kQuietS = 5;
    quiet_ticks_ = output_.detector.level ? 0 : quiet_ticks_ + 1;
    if (!output_.detector.latched || !namer_.said().decided) return;
    const double quiet_s = static_cast<double>(quiet_ticks_) * config_.estimator.period_s;
    const bool over = quiet_s >= kQuietS;
    if (!over && !is_of_another_joint()) return;
    namer_.finish();
    if (over) forget_what_was_learnt();
    clear_latch(state_->detector);
    output_.detector.latched = output_.detector.acts = false;
    quiet_ticks_ = 0;
  }

  // Of a fault that is over it would be one itself.
  void forget_what_was_learnt() {
    const auto fresh = std::make_unique<typename Monitored::State>();
    if (monitor_.reset(state_->sample, *fresh) != Status::kOk) return;
    set_thresholds(thresholds_of(*state_), *fresh);
    state_->estimator = fresh->estimator;
    if constexpr (std::is_same_v<Space, TorqueSpace>) state_->fast = fresh->fast;
  }

  [[nodiscard]] bool is_of_another_joint() const {
    constexpr double kLaterS = 2;
    const auto& said = namer_.said();
    const bool is_of_one = said.kind == FaultKind::kFriction ||
                           said.kind == FaultKind::kLostTorque || said.kind == FaultKind::kOffset;
    const auto& joints = output_.detector.joints;
    return is_of_one && std::any_of(joints.begin(), joints.end(), [&](const auto& joint) {
             return joint.latched && joint.detection_time_s > said.time_s + kLaterS;
           });
  }

  // What is said of the sample that it begins afresh with: no error yet, and the threshold that
  // was.
  void forget() {
    output_.error = at_start_.error;
    output_.error_norm = at_start_.error_norm;
    if constexpr (std::is_same_v<Space, TorqueSpace>) {
      output_.fast_error = at_start_.fast_error;
    }
    output_.psi_hat = at_start_.psi_hat;
    output_.compensation = at_start_.compensation;
    output_.detector = at_start_.detector;
  }

  void say() {
    said_.error = output_.error;
    said_.error_norm = output_.error_norm;
    said_.threshold = output_.threshold;
    said_.psi_hat = output_.psi_hat;
    said_.compensation = output_.compensation.torque;
    said_.weight_norm = std::sqrt(state_->estimator.theta_squared_norm);
    said_.level = output_.detector.level;
    said_.latched = output_.detector.latched;
    said_.acts = output_.detector.acts;
    if constexpr (std::is_same_v<Space, TorqueSpace>) {
      said_.thresholds = output_.thresholds;
      said_.fast_error = output_.fast_error;
      said_.fast_thresholds = output_.fast_thresholds;
      said_.first_joint = said_.latched ? output_.detector.first_joint : -1;
      for (std::size_t i = 0; i < output_.detector.joints.size(); ++i) {
        said_.levels[i] = output_.detector.joints[i].level;
        said_.joint_acts[i] = output_.detector.joints[i].acts;
      }
    }
  }

  RobotDescription robot_;
  Detections detections_;
  bool counts_time_;
  MonitorConfig<kRuntimeJoints, double, Space> config_;
  Monitored monitor_;
  // On the heap: so many hidden units of 12 joints do not belong on a stack.
  std::unique_ptr<typename Monitored::State> state_ = std::make_unique<typename Monitored::State>();
  Output at_start_;
  Output output_;
  FaultNamer<Space> namer_;
  Watched said_;
  std::int64_t missed_ = 0;       // in a row: refused and missing
  std::int64_t quiet_ticks_ = 0;  // in a row without an alarm
  std::uint64_t ticks_ = 0;
};

template <int L>
std::unique_ptr<Watch> make_watch_of(const RobotDescription& robot, double period_s,
                                     const Watch::OnFault& on_fault, Detections detections) {
  if (robot.estimator.space == EstimatorSpace::kTorque) {
    return std::make_unique<WatchOf<TorqueSpace, L>>(robot, period_s, on_fault, detections);
  }
  return std::make_unique<WatchOf<AccelerationSpace, L>>(robot, period_s, on_fault, detections);
}

}  // namespace

std::unique_ptr<Watch> make_watch(const RobotDescription& robot, double period_s,
                                  const Watch::OnFault& on_fault, Detections detections) {
  // A tick takes the time of all that there is room for, and a campaign has a billion of them. What
  // is beyond the robot's own units is and stays 0: the answer is the same to the bit.
  constexpr int kFew = 40;
  constexpr int kUsual = 64;
  const int units = robot.estimator.hidden_units;
  if (units <= kFew) return make_watch_of<kFew>(robot, period_s, on_fault, detections);
  if (units <= kUsual) return make_watch_of<kUsual>(robot, period_s, on_fault, detections);
  return make_watch_of<kMaxHiddenUnits>(robot, period_s, on_fault, detections);
}

}  // namespace offnominal::desk
