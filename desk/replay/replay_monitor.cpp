#include "replay/replay_monitor.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "replay/watch.hpp"

namespace offnominal::desk {
namespace {

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
  ReplayCollector(Eigen::Index samples, int joints, bool has_fast, Replay& result)
      : result_(result), joints_(result.joints.size()) {
    if (!result.joints.empty()) result.thresholds.resize(samples, joints);
    if (has_fast) {
      result.fast_error.resize(samples, joints);
      result.fast_thresholds.resize(samples, joints);
    }
    result.t_s.resize(samples);
    result.error.resize(samples, joints);
    result.error_norm.resize(samples);
    result.threshold.resize(samples);
    result.psi_hat.resize(samples, joints);
  }

  void accept(double t_s, const Watched& output) {
    if (!joints_.empty()) accept_joints(t_s, output);
    result_.t_s[count_] = t_s;
    result_.error.row(count_) = output.error.transpose();
    result_.error_norm[count_] = output.error_norm;
    result_.threshold[count_] = output.threshold;
    result_.psi_hat.row(count_) = output.psi_hat.transpose();
    ++count_;
    end_refusals(t_s);
    const double ratio = ratio_of(output.error_norm, output.threshold);
    result_.max_error_to_threshold = std::max(result_.max_error_to_threshold, ratio);
    result_.max_weight_norm = std::max(result_.max_weight_norm, output.weight_norm);
    any_.take(t_s, output.level, ratio, result_.alarms, result_.detection_time_s);
    if (!joints_.empty() && output.level) name_joints(output);
    if (output.acts && !result_.act_time_s) result_.act_time_s = t_s;
  }

  void refuse(double t_s, Status status) {
    Refusals& refusals = result_.refused[name_of(status)];
    if (refusals.count++ == 0) refusals.first_s = t_s;
    if (refused_in_a_row_++ == 0) first_refused_s_ = t_s;
    last_refused_s_ = t_s;
    result_.longest_refused = std::max(result_.longest_refused, refused_in_a_row_);
  }

  void finish() {
    end_refusals(last_refused_s_);
    result_.t_s.conservativeResize(count_);
    result_.error.conservativeResize(count_, Eigen::NoChange);
    result_.error_norm.conservativeResize(count_);
    result_.threshold.conservativeResize(count_);
    result_.psi_hat.conservativeResize(count_, Eigen::NoChange);
    for (Eigen::MatrixXd* of_joints :
         {&result_.thresholds, &result_.fast_error, &result_.fast_thresholds}) {
      if (of_joints->size() > 0) of_joints->conservativeResize(count_, Eigen::NoChange);
    }
  }

 private:
  void end_refusals(double t_s) {
    if (refused_in_a_row_ > kBorneInARow) {
      result_.blind.push_back({first_refused_s_, t_s, refused_in_a_row_});
    }
    refused_in_a_row_ = 0;
  }

  // Of the stretch that is under way: who has crossed now, and had not before.
  void name_joints(const Watched& output) {
    std::vector<int>& named = result_.alarms.back().joints;
    const auto ratio = [&](int joint) {
      const ResidualAgainst nearest = output.nearest(joint);
      return ratio_of(nearest.residual, nearest.threshold);
    };
    const auto before = static_cast<std::ptrdiff_t>(named.size());
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const int joint = static_cast<int>(i);
      const bool is_named = std::find(named.begin(), named.end(), joint) != named.end();
      if (output.levels[i] && !is_named) named.push_back(joint);
    }
    std::stable_sort(named.begin() + before, named.end(),
                     [&](int a, int b) { return ratio(a) > ratio(b); });
  }

  void accept_joints(double t_s, const Watched& output) {
    result_.thresholds.row(count_) = output.thresholds.transpose();
    const bool has_fast = result_.fast_error.size() > 0;
    if (has_fast) {
      result_.fast_error.row(count_) = output.fast_error.transpose();
      result_.fast_thresholds.row(count_) = output.fast_thresholds.transpose();
    }
    if (output.latched && !result_.first_joint) result_.first_joint = output.first_joint;
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const auto index = static_cast<Eigen::Index>(i);
      const ResidualAgainst nearest = output.nearest(index);
      const double ratio = ratio_of(nearest.residual, nearest.threshold);
      JointReplay& joint = result_.joints[i];
      joint.max_residual = std::max(joint.max_residual, std::abs(output.error[index]));
      joint.max_threshold = std::max(joint.max_threshold, output.thresholds[index]);
      joint.max_ratio_slow = std::max(
          joint.max_ratio_slow, ratio_of(std::abs(output.error[index]), output.thresholds[index]));
      if (has_fast) {
        joint.fast_max_residual =
            std::max(joint.fast_max_residual, std::abs(output.fast_error[index]));
        joint.fast_max_threshold =
            std::max(joint.fast_max_threshold, output.fast_thresholds[index]);
        joint.max_ratio_fast =
            std::max(joint.max_ratio_fast,
                     ratio_of(std::abs(output.fast_error[index]), output.fast_thresholds[index]));
      }
      joint.max_error_to_threshold = std::max(joint.max_error_to_threshold, ratio);
      joints_[i].take(t_s, output.levels[i], ratio, joint.alarms, joint.detection_time_s);
      if (output.joint_acts[i] && !joint.act_time_s) joint.act_time_s = t_s;
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

bool is_same(const IsolatedFault& one, const IsolatedFault& other) {
  return one.kind == other.kind && one.joint == other.joint &&
         std::signbit(one.size) == std::signbit(other.size);
}

}  // namespace

void replay_monitor(const RobotDescription& robot, const Log& log, const OnShare& on_share,
                    Replay& result) {
  // One that lasts is detected again and again; an answer that was decided says more.
  const auto take = [&](const IsolatedFault& fault) {
    if (result.faults.empty() || !is_same(result.faults.back(), fault)) {
      result.faults.push_back(fault);
    } else if (fault.decided && !result.faults.back().decided) {
      result.faults.back() = fault;
    }
  };
  const auto watch = make_watch(robot, log.period_s, take, Detections::kEach);
  ReplayCollector collector(log.sample_count(), robot.joint_count(), robot.estimator.fast_alpha > 0,
                            result);
  constexpr Eigen::Index kToldEvery = 10'000;
  for (Eigen::Index i = 0; i < log.sample_count(); ++i) {
    if (on_share && i % kToldEvery == 0) {
      on_share(static_cast<double>(i) / static_cast<double>(log.sample_count()));
    }
    Watch::Sample sample{
        {log.q.row(i).transpose(), log.dq.row(i).transpose(), log.tau.row(i).transpose()}, {}};
    if (log.readings.rows() > 0) sample.readings = log.readings.row(i).transpose();
    const Status status = watch->take(sample, log.t_s[i], 0);
    if (status == Status::kOk) {
      collector.accept(log.t_s[i], watch->said());
    } else {
      collector.refuse(log.t_s[i], status);
    }
  }
  collector.finish();
  watch->finish();
}

}  // namespace offnominal::desk
