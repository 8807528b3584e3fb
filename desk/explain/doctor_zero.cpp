#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "explain/doctor_checks.hpp"
#include "explain/rereading.hpp"

// Positions that are counted from another zero than the robot file's, or the other way round.

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr std::array kWays{Reading{0, false, false}, Reading{0, false, true},
                           Reading{0, true, true}, Reading{0, true, false}};

constexpr double kStep = std::numbers::pi / 12;  // of the zeros that are tried

double in_a_turn(double angle) { return std::remainder(angle, 2 * std::numbers::pi); }

// The zero near `readings` at which least is left, by thirds.
void refine_zero(const Rereading& rereading, Index joint, Readings& readings) {
  constexpr int kCuts = 14;  // to a thousandth of a radian
  double& zero = readings[static_cast<std::size_t>(joint)].zero;
  double low = zero - kStep;
  double high = zero + kStep;
  const auto left_at = [&](double at) {
    zero = at;
    return rereading.left_by(readings);
  };
  for (int i = 0; i < kCuts; ++i) {
    const double third = (high - low) / 3;
    if (left_at(low + third) < left_at(high - third)) {
      high -= third;
    } else {
      low += third;
    }
  }
  zero = in_a_turn((low + high) / 2);
  constexpr double kNone = 0.01;  // rad
  if (std::abs(zero) < kNone) zero = 0;
}

// Zeros hang on each other: each anew beside the others.
void refine_zeros(const Rereading& rereading, Readings& readings) {
  constexpr int kSweeps = 3;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::size_t joint = 0; joint < readings.size(); ++joint) {
      if (readings[joint].zero != 0) refine_zero(rereading, static_cast<Index>(joint), readings);
    }
  }
}

// Changes the reading of the joint that gains most, if any gains clearly. Returns what is left.
std::optional<double> reread_one(const Rereading& rereading, double left, Readings& readings) {
  constexpr double kClearly = 0.95;
  constexpr double kSimpler = 0.98;  // what another way has to gain on one before it
  constexpr int kZeros = 24;
  double best = kClearly * left;
  std::optional<std::pair<Index, Readings>> found;
  for (Index joint = 0; joint < static_cast<Index>(readings.size()); ++joint) {
    for (int i = 0; i < (rereading.turns(joint) ? kZeros : 1); ++i) {
      for (const Reading& way : kWays) {
        Readings other = readings;
        Reading& changed = other[static_cast<std::size_t>(joint)];
        changed.position_turned = changed.position_turned != way.position_turned;
        changed.torque_turned = changed.torque_turned != way.torque_turned;
        changed.zero = in_a_turn(changed.zero + i * kStep);
        const double now = rereading.left_by(other);
        if (!(now < kSimpler * best)) continue;
        best = now;
        found = {joint, std::move(other)};
      }
    }
  }
  if (!found) return std::nullopt;
  readings = std::move(found->second);
  if (rereading.turns(found->first)) refine_zero(rereading, found->first, readings);
  return rereading.left_by(readings);
}

// Of shares of the torques that two readings leave.
bool is_hardly_more(double left, double than) {
  constexpr double kTimes = 1.3;
  constexpr double kLeast = 0.005;
  return left <= kTimes * than + kLeast;
}

// Whether torques of the wrong sign say the same: of all joints, or of those whose model is worse
// than none.
bool is_by_torque_signs(const Rereading& rereading, const VectorXd& left_as_it_is, double left) {
  const auto joints = static_cast<std::size_t>(left_as_it_is.size());
  Readings all(joints, Reading{0, false, true});
  Readings opposed(joints);
  for (std::size_t joint = 0; joint < joints; ++joint) {
    opposed[joint].torque_turned = left_as_it_is[static_cast<Index>(joint)] > 1;
  }
  return is_hardly_more(std::min(rereading.left_by(all), rereading.left_by(opposed)), left);
}

// Takes back what the others do without.
void leave_out_needless(const Rereading& rereading, Readings& readings) {
  const double left = rereading.left_by(readings);
  for (Reading& one : readings) {
    const Reading was = one;
    Reading without_zero = was;
    without_zero.zero = 0;
    for (const Reading& simpler : {Reading{}, without_zero}) {
      one = simpler;
      if (is_hardly_more(rereading.left_by(readings), left)) break;
      one = was;
    }
  }
}

std::string angle_words(double angle) {
  return fmt::format("{:.4g} rad ({:.3g} deg)", std::abs(angle),
                     std::abs(angle) * 180 / std::numbers::pi);
}

std::string words_of(const Reading& one, Index joint) {
  std::string words = fmt::format("those of joint {}", joint + 1);
  if (one.position_turned) words += " turned about";
  if (one.torque_turned) words += ", as its torques";
  if (one.zero == 0) return words;
  return fmt::format("{}{} and {} {}", words, one.torque_turned ? "," : "", angle_words(one.zero),
                     one.zero > 0 ? "added" : "taken off");
}

void turn(Channel& channel) {
  channel.scale *= -1;
  channel.offset *= -1;
}

// Channels of motors have zeros and senses of their own, which lead to the joints' through the
// transmission.
bool has_motors(const ChannelMap& channels) {
  for (const auto* of : {&channels.position_of, &channels.velocity_of, &channels.torque_of}) {
    for (const ChannelOf one : *of) {
      if (one == ChannelOf::kMotor || one == ChannelOf::kCurrent) return true;
    }
  }
  return false;
}

ChannelMap reread(ChannelMap channels, const Readings& readings) {
  for (std::size_t joint = 0; joint < readings.size(); ++joint) {
    const Reading& one = readings[joint];
    if (joint >= channels.position.size()) break;
    if (one.position_turned) {
      turn(channels.position[joint]);
      if (joint < channels.velocity.size() && channels.velocity[joint]) {
        turn(*channels.velocity[joint]);
      }
    }
    channels.position[joint].offset += one.zero;
    if (!one.torque_turned) continue;
    if (joint < channels.torque.size()) turn(channels.torque[joint]);
    if (joint < channels.sensor_torque.size() && channels.sensor_torque[joint]) {
      turn(*channels.sensor_torque[joint]);
    }
  }
  return channels;
}

// With which as little as possible is left, as far as one joint after the other finds them.
Readings best_readings(const Rereading& rereading, std::size_t joints, double left_as_it_is) {
  Readings readings(joints);
  std::optional<double> left = left_as_it_is;
  for (std::size_t i = 0; i < 2 * joints && left; ++i) {
    left = reread_one(rereading, *left, readings);
  }
  leave_out_needless(rereading, readings);
  refine_zeros(rereading, readings);
  return readings;
}

}  // namespace

bool find_joint_zero(const Log& log, const RobotDescription& robot, const TorquePair& pair,
                     std::vector<DataFault>& faults) {
  constexpr double kLeastWrong = 0.05;
  constexpr double kMostLeft = 0.25;
  // No missing effect or mass is made up for by another zero: that takes little of an error away,
  // and where it is the zero hardly anything is left.
  constexpr double kOfWhatWasLeft = 0.35;  // of the first
  // Of fewer joints, where one alone shows it, or of the last one, a centre of mass elsewhere looks
  // the same; so does a poor CAD of a few links.
  constexpr std::size_t kSureJoints = 3;
  constexpr int kShownBy = 2;
  constexpr double kLeastWrongUnsure = 0.3;
  // By other masses: then it is no zero at all.
  constexpr double kClearlyLess = 0.5;
  const Rereading rereading(log, robot, pair);
  const std::size_t joints = robot.joints.size();
  const VectorXd left_before = rereading.left_of_each(Readings(joints));
  const double before = rereading.left_by(Readings(joints));
  if (!(before > kLeastWrong)) return false;
  const Readings readings = best_readings(rereading, joints, before);
  const double after = rereading.left_by(readings);
  if (!(after < kMostLeft) || !(after < kOfWhatWasLeft * before)) return false;
  if (is_by_torque_signs(rereading, left_before, after)) return false;
  const VectorXd left_after = rereading.left_of_each(readings);
  const auto shown_by = (left_before.array() > kLeastWrong &&
                         left_after.array() < kOfWhatWasLeft * left_before.array())
                            .count();
  const bool is_before_others = std::any_of(readings.begin(), readings.end() - 1,
                                            [](const Reading& one) { return !one.is_as_it_is(); });
  const bool certain = readings.size() >= kSureJoints && shown_by >= kShownBy && is_before_others;
  if (!certain && !(before > kLeastWrongUnsure)) return false;
  std::vector<std::string> words;
  DataFault fault;
  fault.kind = DataFaultKind::kJointZero;
  for (std::size_t joint = 0; joint < readings.size(); ++joint) {
    const Reading& one = readings[joint];
    if (one.is_as_it_is()) continue;
    // A torque of the wrong sign is a fault of its own.
    if (!one.position_turned && one.torque_turned) return false;
    words.push_back(words_of(one, static_cast<Index>(joint)));
    fault.joint = words.size() == 1 ? static_cast<Index>(joint) : -1;
    fault.size = one.zero;
  }
  if (words.empty()) return false;
  fault.unit = "rad";
  const double by_masses = rereading.left_by_masses(after);
  if (by_masses < kClearlyLess * after) return false;
  fault.or_masses = is_hardly_more(by_masses, after);
  fault.certain = certain && !fault.or_masses;
  fault.words = fmt::format(
      "positions {} counted from another zero than the robot file's, or the other way round: with "
      "{}, the model leaves {:.0f} % of the torques unexplained, friction apart, instead of {:.0f} "
      "%{}",
      fault.certain ? "are" : "may be", fmt::join(words, ", "), 100 * after, 100 * before,
      fault.or_masses ? fmt::format(", and with masses and centres of its links that are off, and "
                                    "something carried, {:.0f} %",
                                    100 * by_masses)
                      : "");
  fault.mend =
      "turn the joint's frame in the robot file by its rpy_rad, or its axis about, or read the "
      "positions as the file has them";
  if (has_motors(log.channels)) {
    fault.mend += "; what is recorded of motors hangs on offset_rad and signs of [transmission]";
  } else {
    propose_channels(log, reread(log.channels, readings), {"position", "velocity", "torque"},
                     fault);
  }
  faults.push_back(std::move(fault));
  return true;
}

}  // namespace offnominal::desk
