#include "identify/friction_power.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "compare/inverse_model.hpp"
#include "identify/physical_range.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

bool is_friction(EffectKind kind) { return info_of(kind)->traits.is_friction; }

namespace {

constexpr int kTenths = 10;

// A joint counts as moving above this share of its top speed: slower, the smoothed sign is not full
// and what the filter leaves of an encoder's steps is taken for a direction.
constexpr double kMovingShare = 0.02;

// The friction of a joint and nothing else of it; that of a motor is against the motor's motion,
// not against that of each joint. What a hysteresis stores it gives back, and only what it has far
// from a reversal is taken out of the joint. Scale and delay of the drive change neither the sign
// nor whose torque it is.
VectorXd friction_torque(const RobotDescription& robot, std::size_t joint, const Motion& motion) {
  RobotDescription with = robot;
  std::erase_if(with.effects, [](const RobotEffect& effect) {
    return info_of(effect.kind)->acts_on_whole_drive();
  });
  RobotDescription without = with;
  std::erase_if(without.effects, [&](const RobotEffect& effect) {
    return !effect.of_motor && effect.joint == joint && is_friction(effect.kind);
  });
  const double smoothing =
      kMovingShare * motion.dq.col(static_cast<Index>(joint)).cwiseAbs().maxCoeff();
  for (RobotEffect& effect : with.effects) {
    const bool stores = info_of(effect.kind)->action == EffectAction::kTorqueOfState;
    if (!stores || effect.joint != joint) continue;
    effect.kind = EffectKind::kCoulombFriction;
    effect.parameters[1] = smoothing;
  }
  const auto column = static_cast<Index>(joint);
  BodyTorque bodies;
  const VectorXd torque = model_torque(with, motion, bodies).col(column);
  return torque - model_torque(without, motion, bodies).col(column);
}

struct Tenth {
  double against = 0;  // mean torque against the motion
  double from = 0;
  double to = 0;
};

// The tenth of the samples, in this order, in which the torque against the motion is least.
template <typename Value>
Tenth least_of(const std::vector<Index>& order, const VectorXd& against, const Value& value) {
  Tenth least;
  for (int tenth = 0; tenth < kTenths; ++tenth) {
    const std::size_t begin = order.size() * static_cast<std::size_t>(tenth) / kTenths;
    const std::size_t end = order.size() * static_cast<std::size_t>(tenth + 1) / kTenths;
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += against[order[i]];
    const double mean = sum / static_cast<double>(end - begin);
    if (tenth > 0 && mean >= least.against) continue;
    least = {mean, value(order[begin]), value(order[end - 1])};
  }
  return least;
}

}  // namespace

std::string FrictionDrives::words(const RobotDescription& robot) const {
  const JointType type = robot.joints[joint].joint.type;
  const PhysicalRange dissipation{0, 0, true};
  return fmt::format(
      "the friction of joint {} all together would give energy: {} it drives the joint, with "
      "{:.4g} {} "
      "on average: {}",
      joint + 1, where, torque, unit_of(Quantity::kEffort, type),
      contradicted ? dissipation.usual_cause()
                   : "none at all fits as well: the recording does not show this friction");
}

std::optional<FrictionDrives> friction_that_drives(const RobotDescription& robot, std::size_t joint,
                                                   const Motion& motion, double rms_torque) {
  constexpr double kMatters = 0.02;
  const bool has_friction =
      std::any_of(robot.effects.begin(), robot.effects.end(), [&](const RobotEffect& effect) {
        return !effect.of_motor && effect.joint == joint && is_friction(effect.kind);
      });
  if (!has_friction || motion.sample_count() < 2) return std::nullopt;
  const VectorXd dq = motion.dq.col(static_cast<Index>(joint));
  const double slow = kMovingShare * dq.cwiseAbs().maxCoeff();
  std::vector<Index> moving;
  for (Index i = 0; i < dq.size(); ++i) {
    if (std::abs(dq[i]) > slow) moving.push_back(i);
  }
  if (moving.size() < kTenths) return std::nullopt;
  const VectorXd friction = friction_torque(robot, joint, motion);
  const VectorXd against = friction.array() * dq.array().sign();
  double energy = 0;
  double way = 0;
  for (const Index i : moving) {
    energy += friction[i] * dq[i];
    way += std::abs(dq[i]);
  }

  const auto time = [&](Index i) { return motion.t_s[i]; };
  const auto speed = [&](Index i) { return std::abs(dq[i]); };
  const Tenth by_time = least_of(moving, against, time);
  std::sort(moving.begin(), moving.end(), [&](Index a, Index b) { return speed(a) < speed(b); });
  const Tenth by_speed = least_of(moving, against, speed);

  const JointType type = robot.joints[joint].joint.type;
  FrictionDrives drives{joint, 0, {}, false};
  const bool is_by_time = by_time.against < by_speed.against;
  const Tenth& least = is_by_time ? by_time : by_speed;
  drives.torque = -least.against;
  drives.where = fmt::format("from {:.3g} to {:.3g} {}", least.from, least.to,
                             is_by_time ? "s" : unit_of(Quantity::kVelocity, type));
  drives.contradicted = drives.torque > kMatters * rms_torque;
  if (drives.contradicted) return drives;
  if (energy >= 0) return std::nullopt;
  drives.torque = -energy / way;
  drives.where = "over the whole motion";
  return drives;
}

}  // namespace offnominal::desk
