#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <offnominal/sim/two_link_arm.hpp>
#include <random>

#include "log/log.hpp"
#include "robot/robot.hpp"

// A recording of a two-link arm that follows a given motion exactly: torque from the simulator's
// closed form, plus whatever a test hides in it. Independent of the code under test.

namespace offnominal::test {

struct ArmInstant {
  Eigen::Vector2d q;
  Eigen::Vector2d dq;
  Eigen::Vector2d ddq;
  double t_s = 0;
};
// Torque beyond that of the arm itself, N m.
using HiddenTorque = std::function<Eigen::Vector2d(const ArmInstant&)>;

struct ArmRecording {
  double duration_s = 20;
  double rate_hz = 1000;
  double torque_noise = 0;  // standard deviation, N m
  double encoder_step = 0;  // rad, 0: exact
  std::uint64_t seed = 1;
  double amplitude = 1;  // of the motion
  sim::TwoLinkParameters arm{};
};

inline ArmInstant arm_motion(double t_s, double amplitude) {
  struct Wave {
    double size, frequency_hz, phase;
  };
  constexpr std::array<std::array<Wave, 4>, 2> kWaves{
      {{{{0.9, 0.11, 0.3}, {0.5, 0.31, 1.1}, {0.25, 0.73, 2.0}, {0.08, 1.7, 0.5}}},
       {{{1.1, 0.13, 1.9}, {0.4, 0.37, 0.2}, {0.3, 0.61, 1.3}, {0.07, 1.9, 2.5}}}}};
  ArmInstant at{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), t_s};
  for (Eigen::Index joint = 0; joint < 2; ++joint) {
    for (const Wave& wave : kWaves[static_cast<std::size_t>(joint)]) {
      const double w = 2 * std::numbers::pi * wave.frequency_hz;
      const double angle = w * t_s + wave.phase;
      at.q[joint] += amplitude * wave.size * std::sin(angle);
      at.dq[joint] += amplitude * wave.size * w * std::cos(angle);
      at.ddq[joint] -= amplitude * wave.size * w * w * std::sin(angle);
    }
  }
  return at;
}

inline desk::Log record_arm(const ArmRecording& settings, const HiddenTorque& hidden = {}) {
  std::mt19937_64 generator(settings.seed);
  std::normal_distribution<double> noise(0, 1);
  const auto samples = static_cast<Eigen::Index>(settings.duration_s * settings.rate_hz) + 1;
  desk::Log log;
  log.file = "arm";
  log.period_s = 1 / settings.rate_hz;
  log.t_s.resize(samples);
  log.q.resize(samples, 2);
  log.dq.resize(samples, 2);
  log.tau.resize(samples, 2);
  log.dq_derived = {false, false};
  for (Eigen::Index i = 0; i < samples; ++i) {
    const ArmInstant at = arm_motion(static_cast<double>(i) / settings.rate_hz, settings.amplitude);
    Eigen::Vector2d torque = sim::mass_matrix(settings.arm, at.q) * at.ddq +
                             sim::velocity_torque(settings.arm, {at.q, at.dq}) +
                             sim::gravity_torque(settings.arm, at.q);
    if (hidden) torque += hidden(at);
    for (Eigen::Index joint = 0; joint < 2; ++joint) {
      torque[joint] += settings.torque_noise * noise(generator);
      log.q(i, joint) =
          settings.encoder_step > 0
              ? settings.encoder_step * std::round(at.q[joint] / settings.encoder_step)
              : at.q[joint];
    }
    log.t_s[i] = at.t_s;
    log.dq.row(i) = at.dq;
    log.tau.row(i) = torque;
  }
  return log;
}

// The description that matches the recorded arm, without effects.
inline desk::RobotDescription arm_description() {
  desk::RobotDescription robot;
  robot.name = "arm";
  robot.gravity_m_s2 = {0, -9.81, 0};
  for (const double mass : {0.5, 2.0}) {
    desk::RobotJoint joint;
    joint.name = robot.joints.empty() ? "shoulder" : "elbow";
    joint.joint.mass_kg = mass;
    joint.joint.centre_of_mass_m = {1, 0, 0};
    if (!robot.joints.empty()) joint.joint.origin_m = {1, 0, 0};
    robot.joints.push_back(joint);
  }
  return robot;
}

inline desk::RobotEffect effect_of(EffectKind kind, int joint,
                                   std::array<double, kMaxEffectParameters> parameters,
                                   bool fitted = false) {
  desk::RobotEffect effect;
  effect.kind = kind;
  effect.joint = static_cast<std::uint8_t>(joint);
  effect.parameters = parameters;
  effect.fitted = fitted;
  return effect;
}

}  // namespace offnominal::test
