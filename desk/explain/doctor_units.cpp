#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "common/list_of_joints.hpp"
#include "explain/doctor_checks.hpp"
#include "explain/doctor_signal.hpp"
#include "robot/channel_text.hpp"
#include "robot/units.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kDegreesPerRad = 180 / std::numbers::pi;

struct Unit {
  double per_si;
  const char* name;
};
constexpr std::array kOfRevolute{Unit{kDegreesPerRad, "deg/s"}, Unit{30 / std::numbers::pi, "rpm"},
                                 Unit{0.5 / std::numbers::pi, "turns/s"}};
constexpr std::array kOfPrismatic{Unit{1e3, "mm/s"}, Unit{60, "m/min"}};

double distance(double ratio, double candidate) { return std::abs(std::log(ratio / candidate)); }

bool is_near(double ratio, double candidate) {
  return ratio > 0 && distance(ratio, candidate) < std::log(kNearUnit);
}

bool is_revolute(const RobotDescription& robot, Index joint) {
  return robot.joints[static_cast<std::size_t>(joint)].joint.type == JointType::kRevolute;
}

// The unit that a velocity is in, by its ratio to the derivative; null: none that is known.
const Unit* unit_of_velocity(double ratio, bool revolute) {
  const Unit* best = nullptr;
  const auto consider = [&](const Unit& unit) {
    if (!is_near(ratio, unit.per_si)) return;
    if (best == nullptr || distance(ratio, unit.per_si) < distance(ratio, best->per_si)) {
      best = &unit;
    }
  };
  if (revolute) {
    for (const Unit& unit : kOfRevolute) consider(unit);
  } else {
    for (const Unit& unit : kOfPrismatic) consider(unit);
  }
  return best;
}

// What the velocity may be against the derivative of the position where the time is right.
bool fits_a_unit(double ratio, bool revolute) {
  if (is_near(ratio, 1) || unit_of_velocity(ratio, revolute) != nullptr) return true;
  // Positions in degrees beside velocities in rad/s or in rpm.
  return revolute && (is_near(ratio, 1 / kDegreesPerRad) || is_near(ratio, 1.0 / 6));
}

void scale_velocity(Log& log, ChannelMap& channels, Index joint, double factor) {
  log.dq.col(joint) *= factor;
  const auto index = static_cast<std::size_t>(joint);
  if (index < channels.velocity.size() && channels.velocity[index]) {
    channels.velocity[index]->scale *= factor;
  }
}

}  // namespace

void propose_channels(const Log& log, const ChannelMap& mended, std::vector<std::string> keys,
                      DataFault& fault) {
  if (log.channels.position.empty()) return;
  if (log.common_header) {
    // Whoever has no [channels] yet needs all that it must hold.
    keys = {"position", "torque"};
    if (mended.time.scale != 1) keys.insert(keys.begin(), "time");
    const auto has = [](const auto& channel) { return channel.has_value(); };
    if (std::any_of(mended.velocity.begin(), mended.velocity.end(), has)) {
      keys.insert(keys.end() - 1, "velocity");
    }
  }
  std::string lines;
  bool of_motors = false;
  for (const std::string& key : keys) {
    for (std::string& line : channel_lines(mended, key)) {
      lines += (lines.empty() ? "`" : "; `") + line + "`";
      of_motors = of_motors || line.starts_with("motor_");
      fault.channels.push_back(std::move(line));
    }
  }
  fault.mend += ": under [channels] of the robot file, or in a file for --channels, write " + lines;
  // The lines change a motor's channel, and what is wrong was seen at a joint.
  if (!of_motors) return;
  fault.mend +=
      "; where joints share motors look at [transmission] first: the sign of a number there";
}

namespace {

// The unit that the time is in where it is not s.
struct TimeUnit {
  Unit unit;
  bool certain;  // by velocities, or by torques
};

bool is_multiple_of(double period_s, double wanted_s, double per_si) {
  constexpr double kNear = 1.03;
  return std::abs(std::log(period_s / wanted_s / per_si)) < std::log(kNear);
}

// Recordings of drives have some 20 Hz to 50 kHz; below 5 Hz nothing is left to judge a motion by.
constexpr double kShortestPeriodS = 2e-5;
constexpr double kLongestPeriodS = 0.2;

// A minute, an hour or a day, which every velocity that was measured shows. None: no such unit, or
// the torques follow from s.
std::optional<Unit> long_unit_of_time(const Log& log, const RobotDescription& robot,
                                      const std::vector<std::optional<double>>& ratios) {
  for (const char* name : kLongTimeUnits) {
    const Unit unit{1 / unit_factor(name), name};
    const double period_s = log.period_s / unit.per_si;
    if (period_s < kShortestPeriodS || period_s > kLongestPeriodS) continue;
    Index told = 0;
    Index alike = 0;
    for (const auto& ratio : ratios) {
      if (!ratio) continue;
      ++told;
      if (shows_long_time_unit(*ratio, name)) ++alike;
    }
    if (told == 0 || alike < told) continue;
    if (time_by_torque(log, robot, unit.per_si) == TimeByTorque::kSeconds) return std::nullopt;
    return unit;
  }
  return std::nullopt;
}

// By the velocities where they are measured, else by a period that hardly any recording has, or
// that is the robot file's but for the unit. A slow recording may have either: then the torque
// tells, or nothing does. None: it is s.
std::optional<TimeUnit> unit_of_time(const Log& log, const RobotDescription& robot) {
  const std::vector<std::optional<double>> ratios = velocity_ratios(log);
  if (const auto unit = long_unit_of_time(log, robot, ratios)) return TimeUnit{*unit, true};
  static constexpr std::array kUnits{Unit{1e3, "ms"}, Unit{1e6, "us"}, Unit{1e9, "ns"}};
  bool told = false;      // by a velocity
  bool as_it_is = false;  // a velocity is the derivative, to the unit
  std::array<bool, kUnits.size()> fits{true, true, true};
  bool fits_seconds = true;
  for (Index joint = 0; joint < log.q.cols(); ++joint) {
    const auto& signed_ratio = ratios[static_cast<std::size_t>(joint)];
    if (!signed_ratio) continue;
    const double ratio = std::abs(*signed_ratio);
    const bool revolute = is_revolute(robot, joint);
    told = true;
    as_it_is = as_it_is || is_near(ratio, 1);
    fits_seconds = fits_seconds && fits_a_unit(ratio, revolute);
    for (std::size_t i = 0; i < kUnits.size(); ++i) {
      fits[i] = fits[i] && fits_a_unit(ratio / kUnits[i].per_si, revolute);
    }
  }
  const double wanted = robot.estimator.period_s;
  const bool slow = log.period_s > kLongestPeriodS;
  const bool of_file = !told && std::any_of(kUnits.begin(), kUnits.end(), [&](const Unit& unit) {
    return is_multiple_of(log.period_s, wanted, unit.per_si);
  });
  if (as_it_is || (!slow && !of_file && (!told || fits_seconds))) return std::nullopt;
  const Unit* best = nullptr;
  for (std::size_t i = 0; i < kUnits.size(); ++i) {
    const double period_s = log.period_s / kUnits[i].per_si;
    if (!fits[i] || period_s < kShortestPeriodS || period_s > kLongestPeriodS) continue;
    if (best == nullptr ||
        distance(period_s, wanted) < distance(log.period_s / best->per_si, wanted)) {
      best = &kUnits[i];
    }
  }
  if (best == nullptr) return std::nullopt;
  if (told) return TimeUnit{*best, true};
  switch (time_by_torque(log, robot, best->per_si)) {
    case TimeByTorque::kSeconds:
      return std::nullopt;
    case TimeByTorque::kUnit:
      return TimeUnit{*best, true};
    default:
      return TimeUnit{*best, false};
  }
}

}  // namespace

void mend_time(Log& log, const RobotDescription& robot, std::vector<DataFault>& faults) {
  const auto found = unit_of_time(log, robot);
  if (!found) return;
  const Unit& unit = found->unit;
  DataFault fault;
  fault.kind = DataFaultKind::kTimeUnit;
  fault.size = unit.per_si;
  fault.words = fmt::format(
      "the time {} in {}: taken for s, there is a sample every {:.4g} s, where the robot file's "
      "period_s is {:.4g}",
      found->certain ? "is" : "may be", unit.name, log.period_s, robot.estimator.period_s);
  fault.certain = found->certain;
  for (Index joint = 0; joint < log.q.cols(); ++joint) {
    const auto ratio = velocity_ratio(log, joint);
    if (!ratio) continue;
    fault.words +=
        fmt::format(", and the velocity of joint {} is {:.4g} times the derivative of its position",
                    joint + 1, *ratio);
    break;
  }
  fault.mend = "log seconds, or scale the time";
  ChannelMap mended = log.channels;
  mended.time.scale /= unit.per_si;
  propose_channels(log, mended, {"time"}, fault);
  faults.push_back(std::move(fault));
  if (!found->certain) return;
  log.channels = std::move(mended);
  log.t_s /= unit.per_si;
  log.stamps_s /= unit.per_si;
  change_recorded(log, [&](RecordedRows& rows) { rows.t_s /= unit.per_si; });
  log.period_s /= unit.per_si;
  for (Index joint = 0; joint < log.q.cols(); ++joint) {
    if (log.dq_derived[static_cast<std::size_t>(joint)]) log.dq.col(joint) *= unit.per_si;
  }
}

void mend_velocities(Log& log, const RobotDescription& robot, std::vector<DataFault>& faults) {
  struct Found {
    const Unit* unit;  // null: of no known unit
    double ratio;
    std::vector<Index> joints;
  };
  std::vector<Found> groups;
  Index measured = 0;
  const std::vector<char> held = held_joints(log, robot);
  const std::vector<std::optional<double>> ratios = velocity_ratios(log);
  for (Index joint = 0; joint < log.q.cols(); ++joint) {
    const auto& ratio = ratios[static_cast<std::size_t>(joint)];
    if (!ratio || held[static_cast<std::size_t>(joint)] != 0) continue;
    ++measured;
    if (*ratio > 0 && distance(*ratio, 1) < std::log(kSameUnit)) continue;
    const Unit* unit = unit_of_velocity(*ratio, is_revolute(robot, joint));
    const auto alike = std::find_if(groups.begin(), groups.end(), [&](const Found& group) {
      return unit != nullptr && group.unit == unit;
    });
    if (alike == groups.end()) {
      groups.push_back({unit, *ratio, {joint}});
    } else {
      alike->joints.push_back(joint);
    }
  }
  for (const Found& group : groups) {
    DataFault fault;
    fault.kind = DataFaultKind::kVelocity;
    const bool all = static_cast<Index>(group.joints.size()) == measured && measured > 1;
    fault.joint = all ? -1 : group.joints.front();
    fault.size = group.ratio;
    const std::string of = list_of_joints(group.joints);
    const std::string times =
        fmt::format("{:.4g} times the derivative of the position", group.ratio);
    double factor = 1 / group.ratio;
    if (group.unit != nullptr) {
      factor = 1 / group.unit->per_si;
      fault.words =
          fmt::format("the velocity of {} is in {}: it is {}", of, group.unit->name, times);
      fault.mend = "log rad/s or m/s, or scale the velocity";
    } else if (is_near(-group.ratio, 1)) {
      factor = -1;
      fault.words = fmt::format("the velocity of {} has the wrong sign: it is {}", of, times);
      fault.mend = "turn the sign of the velocity";
    } else {
      fault.words = fmt::format(
          "the velocity of {} is not that of its position: it is {}, as in another unit or before "
          "a gear",
          of, times);
      fault.mend = "look at what was logged, or scale the velocity";
    }
    ChannelMap mended = log.channels;
    for (const Index joint : group.joints) scale_velocity(log, mended, joint, factor);
    propose_channels(log, mended, {"velocity"}, fault);
    log.channels = std::move(mended);
    faults.push_back(std::move(fault));
  }
}

}  // namespace offnominal::desk
