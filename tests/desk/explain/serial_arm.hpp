#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "compare/inverse_model.hpp"
#include "desk/compare/recorded_arm.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

// An arm of any number of joints and a recording of it, for what depends on their number.

namespace offnominal::test {

// Revolute joints about z and y in turn, with viscous and Coulomb friction on each.
inline desk::RobotDescription serial_arm(std::size_t joints) {
  desk::RobotDescription robot;
  robot.name = "serial arm";
  for (std::size_t i = 0; i < joints; ++i) {
    const double size = 1 / (1 + 0.4 * static_cast<double>(i));
    desk::RobotJoint one;
    one.name = "joint " + std::to_string(i + 1);
    if (i % 2 == 1) one.joint.axis = {0, 1, 0};
    if (i > 0) one.joint.origin_m = {0.3 * size, 0, 0.1};
    one.joint.mass_kg = 3 * size;
    one.joint.centre_of_mass_m = {0.12 * size, 0.02, 0.03};
    one.joint.inertia_kg_m2 = {0.02 * size, 0.025 * size, 0.03 * size, 0, 0, 0};
    robot.joints.push_back(one);
    const auto at = static_cast<int>(i);
    robot.effects.push_back(effect_of(EffectKind::kViscousFriction, at, {0.8 * size}, true));
    robot.effects.push_back(effect_of(EffectKind::kCoulombFriction, at, {0.6 * size, 0.01}, true));
  }
  return robot;
}

struct SerialRecording {
  double duration_s = 9;
  double rate_hz = 250;
  double torque_noise_nm = 0.02;
  std::uint64_t seed = 1;
  Eigen::Index held = -1;  // joint that stands, at 0.4 rad; none
  // All move as the first does, less and less, every other one the other way, but for a hundredth.
  bool in_step = false;
};

// Every joint but one that is held moves in five sines of its own; the torque is what `robot`
// needs, and noise.
inline desk::Log record(const desk::RobotDescription& robot, const SerialRecording& settings) {
  const auto samples = static_cast<Eigen::Index>(settings.duration_s * settings.rate_hz) + 1;
  const auto joints = static_cast<Eigen::Index>(robot.joints.size());
  desk::Motion motion;
  motion.t_s = Eigen::VectorXd::LinSpaced(samples, 0, settings.duration_s);
  motion.q = Eigen::MatrixXd::Zero(samples, joints);
  motion.dq = motion.q;
  motion.ddq = motion.q;
  std::mt19937_64 generator(settings.seed);
  std::uniform_real_distribution<double> phase(0, 2 * std::numbers::pi);
  constexpr std::array<std::pair<double, double>, 5> kWaves{
      {{0.9, 0.11}, {0.5, 0.31}, {0.3, 0.47}, {0.25, 0.73}, {0.08, 1.7}}};
  for (Eigen::Index joint = 0; joint < joints; ++joint) {
    for (const auto& [size, frequency_hz] : kWaves) {
      const double w =
          2 * std::numbers::pi * frequency_hz * (1 + 0.07 * static_cast<double>(joint));
      const Eigen::ArrayXd angle = w * motion.t_s.array() + phase(generator);
      if (joint == settings.held) continue;
      motion.q.col(joint).array() += size * angle.sin();
      motion.dq.col(joint).array() += size * w * angle.cos();
      motion.ddq.col(joint).array() -= size * w * w * angle.sin();
    }
  }
  if (settings.in_step) {
    for (Eigen::MatrixXd* of : {&motion.q, &motion.dq, &motion.ddq}) {
      for (Eigen::Index joint = 1; joint < joints; ++joint) {
        of->col(joint) =
            std::pow(-0.8, static_cast<double>(joint)) * of->col(0) + 0.01 * of->col(joint);
      }
    }
  }
  if (settings.held >= 0) motion.q.col(settings.held).setConstant(0.4);
  std::normal_distribution<double> noise(0, settings.torque_noise_nm);
  desk::Log log;
  log.file = "serial arm";
  log.period_s = 1 / settings.rate_hz;
  log.t_s = motion.t_s;
  log.q = motion.q;
  log.dq = motion.dq;
  log.tau = desk::model_torque(robot, motion) +
            Eigen::MatrixXd::NullaryExpr(samples, joints, [&] { return noise(generator); });
  log.dq_derived.assign(robot.joints.size(), false);
  return log;
}

}  // namespace offnominal::test
