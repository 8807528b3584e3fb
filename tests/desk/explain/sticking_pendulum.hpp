#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "log/log.hpp"
#include "log/sampling.hpp"
#include "robot/robot.hpp"

// A pendulum behind a gear whose friction grows with what the gear carries, pulled by a weak spring
// from one angle to the next: there it sticks, with any torque that friction holds.
// Sticking is a state of its own (D. Karnopp, J. Dyn. Sys. Meas. Control 107(1), 1985).

namespace offnominal::test {

struct StickingPendulum {
  std::uint64_t seed = 1;
  double load_factor = 0.3;   // friction per torque that the gear carries
  double dry_nm = 0;          // friction whatever it carries
  double stiffness_nm = 1.2;  // per rad that the pendulum is behind its reference
  double duration_s = 40;
};

inline constexpr double kPendulumMassKg = 0.5;
inline constexpr double kPendulumLengthM = 0.1;
inline constexpr int kPendulumEncoderBits = 12;

inline desk::Log recording_of(const StickingPendulum& made) {
  constexpr double kStep = 1e-4;
  constexpr int kPerSample = 50;  // 200 Hz
  constexpr double kStill = 1e-4;
  constexpr double kDamping = 0.02;
  constexpr double kEveryS = 1.6;
  std::mt19937_64 generator(made.seed);
  std::normal_distribution<double> noise(0, 0.002);
  const double inertia = kPendulumMassKg * kPendulumLengthM * kPendulumLengthM;
  const auto samples = static_cast<Eigen::Index>(made.duration_s / kStep / kPerSample);
  desk::Log log;
  log.file = "sticking pendulum";
  log.period_s = kStep * kPerSample;
  log.t_s.resize(samples);
  log.q.resize(samples, 1);
  log.tau.resize(samples, 1);
  std::uniform_real_distribution<double> anywhere(-1.2, 1.2);
  double from = 0;
  double to = anywhere(generator);
  double from_s = 0;
  double takes_s = 0.4;
  double q = 0;
  double dq = 0;
  double ddq = 0;
  for (Eigen::Index i = 0; i < samples * kPerSample; ++i) {
    const double t = kStep * static_cast<double>(i);
    if (t - from_s > kEveryS) {
      from_s = t;
      from = to;
      to = anywhere(generator);
      takes_s = 0.2 + 0.4 * std::abs(anywhere(generator));
    }
    const double part = std::min(1.0, (t - from_s) / takes_s);
    const double reference = from + (to - from) * 0.5 * (1 - std::cos(std::numbers::pi * part));
    const double drive = made.stiffness_nm * (reference - q) - kDamping * dq;
    const double weight = kPendulumMassKg * 9.81 * kPendulumLengthM * std::sin(q);
    if (i % kPerSample == 0) {
      const Eigen::Index row = i / kPerSample;
      const double count = 2 * std::numbers::pi / std::exp2(kPendulumEncoderBits);
      log.t_s[row] = t;
      log.q(row, 0) = count * std::round(q / count);
      log.tau(row, 0) = drive + noise(generator);
    }
    const double friction = made.dry_nm + made.load_factor * std::abs(weight + inertia * ddq);
    const double pull = drive - weight;
    if (std::abs(dq) < kStill && std::abs(pull) <= friction) {
      dq = 0;
      ddq = 0;
      continue;
    }
    const double way = std::abs(dq) < kStill ? pull : dq;
    ddq = (pull - std::copysign(friction, way)) / inertia;
    const double next = dq + kStep * ddq;
    dq = dq * next < 0 ? 0 : next;
    q += kStep * dq;
  }
  log.dq.resize(samples, 1);
  log.dq_derived = {true};
  desk::derive_velocities(log);
  return log;
}

// Hangs down at 0; what its motor loses is in the file, what its gear loses is not.
inline desk::RobotDescription pendulum() {
  desk::RobotDescription robot;
  robot.name = "pendulum";
  desk::RobotJoint joint;
  joint.name = "hinge";
  joint.joint.axis = {0, 1, 0};
  joint.joint.mass_kg = kPendulumMassKg;
  joint.joint.centre_of_mass_m = {0, 0, -kPendulumLengthM};
  joint.encoder.counts_per_unit = std::exp2(kPendulumEncoderBits) / (2 * std::numbers::pi);
  robot.joints.push_back(joint);
  return robot;
}

}  // namespace offnominal::test
