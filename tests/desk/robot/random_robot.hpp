#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <offnominal/diagnosis/joint_bound.hpp>
#include <random>
#include <string>
#include <vector>

#include "robot/friction_sign.hpp"
#include "robot/read_joint.hpp"
#include "robot/robot.hpp"

namespace offnominal::test {

/// Robots of every shape that a robot file can hold, drawn from one generator.
class RandomRobot {
 public:
  explicit RandomRobot(std::mt19937_64& generator) : generator_(generator) {}

  desk::RobotDescription draw() {
    desk::RobotDescription robot;
    robot.name = word();
    robot.source = any_text();
    robot.gravity_m_s2 = {length(), length(), length()};
    const int joints = whole(1, kMaxJoints);
    for (int i = 0; i < joints; ++i) robot.joints.push_back(joint(i));
    if (coin()) robot.transmission = transmission(joints);
    const int effects = whole(0, kEffectsPerJoint * joints);
    for (int i = 0; i < effects; ++i) robot.effects.push_back(effect(robot));
    robot.estimator = estimator();
    robot.arming = arming(joints);
    if (coin()) robot.bound = bound(joints, robot.estimator);
    if (coin()) robot.drives = drives(joints, robot.estimator.period_s);
    // Axes of their own have no place beside joints that share motors.
    const bool shares = robot.transmission && !robot.transmission->matrix.empty();
    if (shares && robot.drives && robot.drives->protocol != 0) robot.drives.reset();
    if (coin()) {
      robot.channels = channels(joints);
      if (robot.transmission) add_sides(*robot.channels, *robot.transmission);
    }
    return robot;
  }

 private:
  bool coin() { return whole(0, 1) == 1; }
  int whole(int min, int max) { return std::uniform_int_distribution<int>(min, max)(generator_); }
  double uniform() { return std::uniform_real_distribution<double>(-1, 1)(generator_); }

  // Up to which a robot file takes lengths and gravity; powers of 2 up to which it takes
  // parameters, masses, and bounds.
  static constexpr double kLongest = 100;
  static constexpr int kLargestParameter = 15;
  static constexpr int kLargestMass = 22;
  static constexpr int kLargestOfBound = 38;

  // Of any size, whole numbers and both zeros among them.
  double number(int largest = 60) {
    switch (whole(0, 4)) {
      case 0:
        return coin() ? 0.0 : -0.0;
      case 1:
        return whole(-1000, 1000);
      default:
        return std::ldexp(uniform(), whole(-60, largest));
    }
  }
  double positive(int largest = 30) {
    return std::ldexp(1 + std::fabs(uniform()), whole(-28, largest));
  }
  double length() { return std::clamp(number(6), -kLongest, kLongest); }
  std::string word() { return "w" + std::to_string(whole(0, 1 << 30)); }
  std::string any_text() {
    const std::string parts[]{"a",      " ", "\"", "\\", "\n",   "\t",
                              "\"\"\"", "#", "é",  "\r", "\x1b", "'"};
    std::string text;
    for (int i = whole(0, 12); i > 0; --i) text += parts[whole(0, 11)];
    return text;
  }

  desk::RobotJoint joint(int index) {
    desk::RobotJoint result;
    result.name = word() + std::to_string(index);
    result.source = any_text();
    Joint<double>& joint = result.joint;
    joint.type = coin() ? JointType::kRevolute : JointType::kPrismatic;
    const Eigen::Vector3d axis = Eigen::Vector3d(uniform(), uniform(), uniform() + 2).normalized();
    joint.axis = {axis[0], axis[1], axis[2]};
    joint.origin_m = {length(), length(), length()};
    const Eigen::Matrix3d turn = Eigen::Quaterniond(uniform(), uniform(), uniform(), 1 + uniform())
                                     .normalized()
                                     .toRotationMatrix();
    if (coin()) {
      for (int i = 0; i < 9; ++i) joint.rotation[static_cast<std::size_t>(i)] = turn(i / 3, i % 3);
    }
    joint.mass_kg = positive(kLargestMass);
    joint.centre_of_mass_m = {length(), length(), length()};
    if (coin()) joint.inertia_kg_m2 = inertia(turn);
    if (coin()) joint.min_position = -positive();
    if (coin()) joint.max_position = positive();
    if (coin()) joint.max_velocity = positive();
    if (coin()) joint.max_torque = positive();
    if (coin()) result.encoder.counts_per_unit = positive();
    if (coin() && joint.type == JointType::kRevolute) {
      result.encoder.counts_per_unit = desk::counts_per_rad(whole(1, desk::kMaxEncoderBits));
    }
    if (coin()) result.kp = positive();
    if (coin()) result.kd = positive();
    return result;
  }

  // Of a solid box, turned.
  std::array<double, 6> inertia(const Eigen::Matrix3d& turn) {
    const Eigen::Vector3d squares(positive(), positive(), positive());
    const Eigen::Vector3d moments = squares.sum() * Eigen::Vector3d::Ones() - squares;
    const Eigen::Matrix3d tensor = turn * moments.asDiagonal() * turn.transpose();
    return {tensor(0, 0), tensor(1, 1), tensor(2, 2), tensor(0, 1), tensor(0, 2), tensor(1, 2)};
  }

  desk::RobotEffect effect(const desk::RobotDescription& robot) {
    desk::RobotEffect result;
    const EffectInfo& info = kAllEffectInfos[static_cast<std::size_t>(
        whole(0, static_cast<int>(kAllEffectInfos.size()) - 1))];
    result.kind = info.kind;
    result.joint = static_cast<std::uint8_t>(whole(0, robot.joint_count() - 1));
    for (std::size_t i = 0; i < info.parameters.size(); ++i) {
      const ParameterInfo& parameter = info.parameters[i];
      if (parameter.quantity == Quantity::kJointNumber) {
        if (robot.joint_count() == 1) return effect(robot);
        const int other = whole(1, robot.joint_count() - 1);
        result.parameters[i] = other + (other > result.joint ? 1 : 0);
        continue;
      }
      const double value =
          parameter.quantity == Quantity::kLength ? length() : number(kLargestParameter);
      const double min = desk::takes_energy_out(info.traits, parameter) ? 0 : parameter.min;
      result.parameters[i] = value >= min ? value : positive(kLargestParameter);
      // A small share of the range: those of one joint may have to add up to no more than its end.
      if (parameter.max < effects::kAny) {
        constexpr double kMost = kEffectsPerJoint * kMaxJoints;
        result.parameters[i] =
            parameter.min + (parameter.max - parameter.min) * std::fabs(uniform()) / kMost;
      }
    }
    // All those of one joint are shorter than the ticks that a monitor keeps.
    if (result.kind == EffectKind::kTimeDelay) result.parameters[0] = 1e-9 * std::fabs(uniform());
    // Less mass than none may leave a joint nothing to move.
    const bool is_mass =
        result.kind == EffectKind::kLinkMass || result.kind == EffectKind::kTipPayload;
    if (is_mass) result.parameters[0] = std::fabs(result.parameters[0]);
    result.of_motor = robot.transmission && motor_may_have(result.kind) && coin();
    result.fitted = coin();
    result.source = any_text();
    return result;
  }

  // With rows that differ: the diagonal outweighs the rest.
  desk::TransmissionSettings transmission(int joints) {
    desk::TransmissionSettings settings;
    settings.source = any_text();
    const auto ratio = [&] { return (coin() ? 1 : -1) * (1 + std::fabs(uniform())) * 100; };
    const bool coupled = coin();
    for (int i = 0; i < joints; ++i) {
      if (!coupled) settings.ratio.push_back(ratio());
      if (!coupled) continue;
      auto& row = settings.matrix.emplace_back();
      for (int k = 0; k < joints; ++k) row.push_back(i == k ? ratio() : 10 * uniform());
    }
    for (int i = 0; i < joints; ++i) {
      settings.offset_rad.push_back(uniform());
      settings.torque_constant.push_back(ratio() / 1000);
    }
    if (coin()) settings.offset_rad.clear();
    return settings;
  }

  // All on one side where all joints share motors, each on its own otherwise.
  void add_sides(desk::ChannelMap& map, const desk::TransmissionSettings& transmission) {
    const std::size_t joints = map.position.size();
    const bool mixed = transmission.matrix.empty();
    const auto sides = [&](int most) {
      std::vector<desk::ChannelOf> of(joints, static_cast<desk::ChannelOf>(whole(0, most)));
      for (auto& one : of) {
        if (mixed) one = static_cast<desk::ChannelOf>(whole(0, most));
      }
      const bool all_joints = std::all_of(
          of.begin(), of.end(), [](desk::ChannelOf one) { return one == desk::ChannelOf::kJoint; });
      return all_joints ? std::vector<desk::ChannelOf>{} : of;
    };
    map.position_of = sides(1);
    map.torque_of = sides(3);
    for (std::size_t i = 0; i < joints && coin(); ++i) {
      if (i < map.torque_of.size() && map.torque_of[i] == desk::ChannelOf::kSensor) continue;
      map.sensor_torque.resize(joints);
      map.sensor_torque[i] = channel();
    }
  }

  desk::EstimatorSettings estimator() {
    desk::EstimatorSettings settings;
    settings.period_s = positive();
    settings.alpha = 0.9 / settings.period_s;
    settings.hidden_units = whole(1, desk::kMaxHiddenUnits);
    settings.learning_rate = coin() ? positive() : 0.0;
    settings.weight_radius = positive();
    settings.initial_weight_range = settings.weight_radius / 100;
    settings.seed = static_cast<std::uint32_t>(generator_());
    settings.dead_zone = coin() ? DeadZone::kContinuous : DeadZone::kDiscontinuous;
    settings.torque_signal = coin() ? TorqueSignal::kSampled : TorqueSignal::kHeld;
    settings.space = coin() ? desk::EstimatorSpace::kAcceleration : desk::EstimatorSpace::kTorque;
    if (settings.space == desk::EstimatorSpace::kTorque && coin()) {
      settings.fast_alpha = 0.95 / settings.period_s;
    }
    settings.source = any_text();
    return settings;
  }

  desk::ArmingSettings arming(int joints) {
    const auto per_joint = [&] {
      std::vector<double> values;
      for (int i = 0; i < joints; ++i) values.push_back(positive());
      return coin() ? values : std::vector<double>{};
    };
    desk::ArmingSettings settings;
    settings.position_window = per_joint();
    settings.speed = per_joint();
    settings.torque_rate = per_joint();
    if (coin()) settings.ramp_s = positive();
    settings.source = any_text();
    return settings;
  }

  desk::JointBoundSettings joint_bound() {
    desk::JointBoundSettings result;
    result.value = {positive()};
    if (coin()) result.act_ratio = 1 + positive();
    if (coin()) return result;
    result.variable = static_cast<BoundVariable>(whole(0, 2));
    result.at = {result.variable == BoundVariable::kPosition ? number(kLargestOfBound) : 0};
    for (int i = whole(1, kMaxJointBoundPoints - 1); i > 0; --i) {
      result.at.push_back(
          std::nextafter(result.at.back() + positive(), std::numeric_limits<double>::max()));
      result.value.push_back(positive());
    }
    return result;
  }

  desk::BoundSettings bound(int joints, const desk::EstimatorSettings& estimator) {
    desk::BoundSettings result;
    result.source = any_text();
    if (estimator.space == desk::EstimatorSpace::kTorque) {
      result.kind = desk::BoundSettings::Kind::kPerJoint;
      for (int i = 0; i < joints; ++i) {
        result.joints.push_back(joint_bound());
        if (coin()) result.joints.back().momentum_error = positive();
        if (estimator.fast_alpha > 0) result.fast.push_back(joint_bound());
      }
      return result;
    }
    if (coin()) result.velocity_error = positive();
    result.kind = static_cast<desk::BoundSettings::Kind>(whole(0, 2));
    if (result.kind == desk::BoundSettings::Kind::kConstant) result.constant.value = positive();
    if (result.kind == desk::BoundSettings::Kind::kScaledNorm) {
      result.scaled_norm.scale = positive();
      result.scaled_norm.offset = coin() ? positive() : 0.0;
      for (int row = whole(1, joints); row > 0; --row) {
        auto& numbers = result.scaled_norm.matrix.emplace_back();
        for (int i = 0; i < joints; ++i) numbers.push_back(number(kLargestOfBound));
      }
    }
    if (result.kind == desk::BoundSettings::Kind::kTable) {
      result.table.variable = static_cast<BoundVariable>(whole(0, 2));
      result.table.joint = whole(0, joints - 1);
      double at = number(kLargestOfBound);
      for (int i = whole(1, 16); i > 0; --i) {
        result.table.at.push_back(at);
        result.table.value.push_back(positive());
        at = std::nextafter(at + positive(), std::numeric_limits<double>::max());
      }
    }
    return result;
  }

  // ODrives where ticks are long enough for them.
  desk::DriveSettings drives(int joints, double period_s) {
    desk::DriveSettings settings;
    settings.source = any_text();
    if (coin() || period_s < 0.001) return settings;
    settings.protocol = 1;
    settings.shared = {1.0 * whole(0, 1), 0.001, 0.001 * whole(1, 100), 0.001 * whole(0, 100)};
    const int first = whole(0, 63 - joints);
    for (int i = 0; i < joints; ++i) {
      const double per_turn =
          (coin() ? 1 : -1) * std::ldexp(1 + std::fabs(uniform()), whole(-9, 8));
      settings.of_joints.insert(settings.of_joints.end(), {1.0 * (first + i), per_turn, per_turn});
    }
    return settings;
  }

  desk::Channel term() {
    desk::Channel result;
    result.source = "c" + any_text();
    if (coin()) {
      result.scale = positive();
      result.unit = "u" + any_text();
    }
    if (coin()) result.scale_source = "g" + any_text();
    return result;
  }

  desk::Channel channel() {
    desk::Channel result = term();
    if (coin()) result.offset = number();
    if (whole(0, 3) > 0) return result;
    result.source.clear();
    for (int i = whole(2, 4); i > 0; --i) result.sum.push_back(term());
    return result;
  }

  desk::ChannelMap channels(int joints) {
    desk::ChannelMap map;
    map.at_rest = whole(0, 3) == 0;
    map.time = channel();
    if (map.at_rest) {  // none is read
      map.time = desk::Channel();
      map.time.source = "t";
    } else if (coin()) {
      map.more_times = {channel()};
    }
    if (!map.at_rest && whole(0, 3) == 0) {
      map.period_s = positive();
      map.time = desk::Channel();
      map.time.source = "t";
      map.more_times.clear();
    }
    for (int i = 0; i < joints; ++i) {
      map.position.push_back(channel());
      map.velocity.push_back(!map.at_rest && coin() ? std::optional(channel()) : std::nullopt);
      map.torque.push_back(channel());
    }
    if (coin()) map.dbc = "/" + word() + any_text();
    for (int i = whole(0, 2); i > 0; --i) {
      map.payloads.push_back({word() + any_text(), {50 * (1 + uniform()), {uniform(), 0, -1e-3}}});
    }
    if (map.at_rest) return map;
    for (int i = whole(0, 3); i > 0; --i) map.extra[word() + any_text()] = channel();
    return map;
  }

  std::mt19937_64& generator_;
};

}  // namespace offnominal::test
