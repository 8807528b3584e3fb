#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "log/hold_map.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

// A brushless motor that is led from position to position and held there, by the energy between its
// magnets and its teeth: no harmonics are put in, they follow from how many of each there are.

namespace offnominal::test {

struct HeldMotor {
  std::uint64_t seed = 1;
  int slots = 18;
  int magnets = 24;
  double unevenness = 0.35;    // of each tooth and each magnet, uniform about 1
  double cogging_nm = 0.008;   // rms; 0: none
  double friction_nm = 0.002;  // that holds it where it stops
  double noise_nm = 0.0004;    // of a reading
  double bristle_rad = 0.004;  // over which friction builds up after a reversal
};

// Pull of one tooth on one magnet at an angle between them, -d/dq of exp(k (cos q - 1)).
inline double pull(double angle) {
  constexpr double kNarrow = 1500;
  return kNarrow * std::sin(angle) * std::exp(kNarrow * (std::cos(angle) - 1));
}

// Once up and once down over a little more than a turn, some readings at every position.
inline desk::Log hold_map_of(const HeldMotor& motor) {
  constexpr double kTurn = 2 * std::numbers::pi;
  constexpr double kBeyond = 0.05;
  std::mt19937_64 generator(motor.seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> noise(0, motor.noise_nm);
  std::vector<double> teeth;
  std::vector<double> poles;
  for (int i = 0; i < motor.slots; ++i) teeth.push_back(1 + motor.unevenness * uniform(generator));
  for (int i = 0; i < motor.magnets; ++i) {
    poles.push_back(1 + motor.unevenness * uniform(generator));
  }
  const auto cogging = [&](double q) {
    double torque = 0;
    for (int i = 0; i < motor.slots; ++i) {
      for (int j = 0; j < motor.magnets; ++j) {
        torque += teeth[static_cast<std::size_t>(i)] * poles[static_cast<std::size_t>(j)] *
                  pull(q - kTurn * i / motor.slots + kTurn * j / motor.magnets);
      }
    }
    return torque;
  };
  std::vector<double> at;
  std::vector<double> torque;
  std::vector<double> rigid;
  double bristle = 0;
  double q = 0;
  for (const double way : {1.0, -1.0}) {
    while (way > 0 ? q < kTurn + kBeyond : q > -kBeyond) {
      const double step = 0.004 * (1 + 0.6 * uniform(generator));
      q += way * step;
      bristle = way + (bristle - way) * std::exp(-step / motor.bristle_rad);
      const double pulled = cogging(q);
      const int readings = 1 + static_cast<int>(generator() % 3);
      for (int i = 0; i < readings; ++i) {
        at.push_back(q);
        rigid.push_back(pulled);
        torque.push_back(motor.friction_nm * bristle + noise(generator));
      }
    }
  }
  const auto size = static_cast<Eigen::Index>(at.size());
  const Eigen::Map<const Eigen::VectorXd> pulled(rigid.data(), size);
  const double rms = std::sqrt(pulled.squaredNorm() / static_cast<double>(size));
  desk::Log log;
  log.file = "held motor";
  log.q = Eigen::Map<const Eigen::VectorXd>(at.data(), size);
  log.tau =
      Eigen::Map<const Eigen::VectorXd>(torque.data(), size) + motor.cogging_nm / rms * pulled;
  desk::make_hold_map(log);
  return log;
}

// A balanced rotor on a vertical axis.
inline desk::RobotDescription rotor() {
  desk::RobotDescription robot;
  robot.name = "rotor";
  desk::RobotJoint joint;
  joint.name = "rotor";
  joint.joint.mass_kg = 0.05;
  joint.joint.inertia_kg_m2 = {1e-5, 1e-5, 1.8e-5, 0, 0, 0};
  joint.joint.axis = {0, 0, 1};
  robot.joints.push_back(joint);
  return robot;
}

}  // namespace offnominal::test
