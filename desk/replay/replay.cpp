#include "replay/replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <offnominal/diagnosis/estimator_config.hpp>
#include <offnominal/model/quantity.hpp>
#include <utility>

#include "common/amount.hpp"
#include "common/error.hpp"
#include "common/nearest.hpp"
#include "common/number.hpp"
#include "log/seen_by_sensor.hpp"
#include "replay/replay_monitor.hpp"
#include "replay/watch.hpp"
#include "robot/payload.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {
namespace {

void check_settings(const RobotDescription& robot, const Log& log) {
  if (log.q.cols() != robot.joint_count()) {
    throw InputError(
        {.file = log.file,
         .place = "columns",
         .found = counted(static_cast<std::size_t>(log.q.cols()), "joint"),
         .allowed = std::to_string(robot.joint_count()) + ", as robot " + robot.name + " has",
         .mend = "give the recording's own robot file"});
  }
  require_bound(robot, "robot " + robot.name);
  const auto require_followed = [&](const std::string& key, double alpha_per_s) {
    const double pole = alpha_per_s * log.period_s;
    if (pole <= kMaxPolePerTick) return;
    throw InputError(
        {.file = log.file,
         .place = "sampling period " + shortest(log.period_s) + " s",
         .found = key + " * period = " + shortest(pole),
         .allowed = "at most " + shortest(kMaxPolePerTick),
         .mend = "lower " + key + " in the robot file, or take a recording with faster sampling"});
  };
  require_followed("alpha_per_s", robot.estimator.alpha);
  require_followed("fast_alpha_per_s", robot.estimator.fast_alpha);
  if (robot.estimator.hidden_units > kMaxHiddenUnits) {
    throw InputError({.file = "robot " + robot.name,
                      .place = "estimator.hidden_units",
                      .found = std::to_string(robot.estimator.hidden_units),
                      .allowed = "at most " + std::to_string(kMaxHiddenUnits),
                      .mend = "use fewer hidden units"});
  }
}

std::string common_unit(const RobotDescription& robot, Quantity quantity,
                        const std::string& otherwise) {
  const JointType first = robot.joints.front().joint.type;
  for (const RobotJoint& joint : robot.joints) {
    if (joint.joint.type != first) return otherwise;
  }
  return unit_of(quantity, first);
}

}  // namespace

std::int64_t Replay::samples() const {
  return std::accumulate(
      refused.begin(), refused.end(), static_cast<std::int64_t>(t_s.size()),
      [](std::int64_t sum, const auto& item) { return sum + item.second.count; });
}

Replay replay(const RobotDescription& robot, const Log& log, const OnShare& on_share) {
  check_settings(robot, log);
  const RobotDescription seen = seen_by_sensors(robot, log);
  Replay result;
  result.robot = robot.name;
  result.log = log.file;
  const bool in_torque = robot.estimator.space == EstimatorSpace::kTorque;
  result.space = robot.estimator.space;
  result.unit = in_torque ? common_unit(robot, Quantity::kEffort, "N m or N")
                          : common_unit(robot, Quantity::kVelocity, "1");
  result.period_s = log.period_s;
  result.hidden_units = robot.estimator.hidden_units;
  result.seed = robot.estimator.seed;
  result.filter_s = 1 / robot.estimator.alpha;
  result.has_two_levels = robot.bound->has_two_levels();
  for (const RobotJoint& joint : robot.joints) {
    result.joint_names.push_back(joint.name);
    const JointType type = joint.joint.type;
    const char* const acceleration = type == JointType::kRevolute ? "rad/s^2" : "m/s^2";
    result.psi_hat_units.emplace_back(in_torque ? unit_of(Quantity::kEffort, type) : acceleration);
    if (!in_torque) continue;
    const std::size_t i = result.joints.size();
    JointReplay& of_joint = result.joints.emplace_back();
    of_joint.unit = unit_of(Quantity::kEffort, type);
    of_joint.act_ratio = robot.bound->joints[i].act_ratio;
    if (!robot.bound->fast.empty()) of_joint.fast_act_ratio = robot.bound->fast[i].act_ratio;
  }
  replay_monitor(carrying(seen, log.payload), log, on_share, result);
  if (result.t_s.size() == 0) {
    const auto& [status, refusals] = *result.refused.begin();
    throw InputError({.file = log.file,
                      .place = fmt::format("all {} samples", refusals.count),
                      .found = "refused with status " + status,
                      .allowed = "samples inside the joint limits of the robot file",
                      .mend = "check the units of the recording, [channels] and [joint.limits]"});
  }
  return result;
}

bool Replay::is_blind() const {
  constexpr std::int64_t kBorneOneIn = 100;
  return longest_refused > kBorneInARow || (samples() - judged()) * kBorneOneIn > samples();
}

double Replay::blind_s() const {
  return std::accumulate(blind.begin(), blind.end(), 0.0, [](double sum, const BlindStretch& one) {
    return sum + one.end_s - one.start_s;
  });
}

bool Replay::is_too_short() const {
  constexpr double kTimeConstants = 3;  // until 95 % of a step are there
  return t_s.size() == 0 || t_s[t_s.size() - 1] - t_s[0] < kTimeConstants * filter_s;
}

namespace {

std::string names_of(const Replay& replay, const std::vector<int>& joints) {
  return list_of(joints, [&](int joint) {
    return fmt::format("joint {} ({})", joint + 1,
                       replay.joint_names[static_cast<std::size_t>(joint)]);
  });
}

// The joint that crossed first, and the others in the order in which they followed.
std::string joints_words(const Replay& replay) {
  const auto first = static_cast<std::size_t>(*replay.first_joint);
  const double at_s = *replay.detection_time_s;
  std::vector<std::pair<double, std::size_t>> later;
  for (std::size_t i = 0; i < replay.joints.size(); ++i) {
    const JointReplay& joint = replay.joints[i];
    if (i != first && joint.detection_time_s) later.emplace_back(*joint.detection_time_s, i);
  }
  std::sort(later.begin(), later.end());
  const JointReplay& crossed = replay.joints[first];
  std::string words =
      fmt::format("Off nominal: joint {} ({}) first, ", first + 1, replay.joint_names[first]);
  const bool jumped = !crossed.alarms.empty() && crossed.alarms.front().is_jump();
  words += jumped ? fmt::format("at {:.3f} s its position is where no motion brings it", at_s)
                  : fmt::format("its residual crosses its threshold at {:.3f} s, up to {:.3g} {}",
                                at_s, crossed.largest_beyond(), crossed.unit);
  for (std::size_t k = 0; k < later.size(); ++k) {
    const auto& [time_s, joint] = later[k];
    words += fmt::format("{} joint {} ({}) ", k == 0 ? "; then" : ",", joint + 1,
                         replay.joint_names[joint]);
    words += time_s > at_s ? fmt::format("{:.3f} s after it", time_s - at_s)
                           : std::string("in the same tick");
  }
  return words + ".";
}

// When it first came to act, and whose residual that was.
std::string act_words(const Replay& replay) {
  if (!replay.act_time_s) return " Never beyond the level to act.";
  std::vector<int> joints;
  for (std::size_t i = 0; i < replay.joints.size(); ++i) {
    if (replay.joints[i].act_time_s == replay.act_time_s) joints.push_back(static_cast<int>(i));
  }
  return fmt::format(" Beyond the level to act at {:.3f} s, {}.", *replay.act_time_s,
                     names_of(replay, joints));
}

// Nobody saw what was there: neither "nominal" nor "off nominal" speaks of it.
std::string blind_words(const Replay& replay) {
  const BlindStretch& first = replay.blind.front();
  const bool one = replay.blind.size() == 1;
  return fmt::format(
      " Blind for {:.3f} s{}, {}from {:.3f} to {:.3f} s: what happened there nobody saw, and the "
      "monitor began afresh behind {}.",
      replay.blind_s(),
      one ? "" : " in all, in " + counted(replay.blind.size(), "stretch", "stretches"),
      one ? "" : "the first ", first.start_s, first.end_s, one ? "it" : "each");
}

}  // namespace

std::string words_of(const Replay& replay) {
  std::string words;
  if (replay.first_joint) {
    words = joints_words(replay);
  } else if (replay.detection_time_s) {
    words = fmt::format("Off nominal: the residual crosses its threshold at {:.3f} s, in {}.",
                        *replay.detection_time_s,
                        counted(replay.alarms.size(), "stretch", "stretches"));
  } else if (replay.is_blind()) {
    words = fmt::format(
        "Blind: {} of {} samples were judged, at most {} in a row were not; in those that were the "
        "residual is at most {:.1f} % of its threshold.",
        replay.judged(), replay.samples(), replay.longest_refused,
        100 * replay.max_error_to_threshold);
  } else if (replay.is_too_short()) {
    words = fmt::format(
        "Too short to judge: a residual takes {:.3g} s to build up (3 / alpha), and {:.3g} s are "
        "there; in them it is at most {:.1f} % of its threshold.",
        3 * replay.filter_s, replay.t_s[replay.t_s.size() - 1] - replay.t_s[0],
        100 * replay.max_error_to_threshold);
  } else {
    words = fmt::format("Nominal: the residual stays below its threshold, at most {:.1f} % of it.",
                        100 * replay.max_error_to_threshold);
  }
  if (replay.has_two_levels && replay.detection_time_s) {
    words += act_words(replay);
  }
  for (std::size_t i = 0; i < replay.faults.size(); ++i) {
    const IsolatedFault& fault = replay.faults[i];
    if (i > 0) words += fmt::format(" Detected anew at {:.3f} s:", fault.detection_time_s);
    words += " " + words_of(fault, replay.joint_names) + ".";
  }
  if (!replay.blind.empty()) words += blind_words(replay);
  for (const auto& [status, refusals] : replay.refused) {
    words += fmt::format(" {} refused ({}, first at {:.3f} s).",
                         counted(static_cast<std::size_t>(refusals.count), "sample"), status,
                         refusals.first_s);
  }
  return words;
}

std::string ratio_name(const Replay& replay) {
  return replay.joints.empty() ? "largest |e| / mu" : "largest residual / threshold";
}

std::string joints_of(const Replay& replay, const Alarm& alarm) {
  return names_of(replay, alarm.joints);
}

}  // namespace offnominal::desk
