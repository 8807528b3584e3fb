#include "detection_case.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "arm_recording.hpp"
#include "arm_robot.hpp"
#include "arm_sketch.hpp"
#include "campaign/cad_errors.hpp"
#include "log/read_log.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::bench {
namespace {

using sim::hidden::Draws;
using sim::hidden::Stream;

constexpr double kCadError = 0.03;
constexpr double kFrictionError = 0.1;
constexpr double kTorqueNoise = 0.002;

desk::RobotDescription true_robot() {
  desk::RobotDescription robot = desk::read_robot_file(OFFNOMINAL_DETECTION_ROBOT);
  for (desk::RobotJoint& joint : robot.joints) {
    joint.joint.max_torque = std::numeric_limits<double>::max();
    joint.joint.max_velocity = std::numeric_limits<double>::max();
  }
  return robot;
}

ArmEffect effect_of(EffectKind kind, Eigen::Index joint, const std::vector<double>& values) {
  ArmEffect effect{kind, joint, {}, kFaultS};
  for (const double value : values) effect.numbers.emplace_back("", value);
  return effect;
}

DetectionFault on_joint(std::string words, EffectKind kind, int joint, double size) {
  return {std::move(words), effect_of(kind, joint, {size}), {}, joint};
}

DetectionFault push(std::string words, Eigen::Index link, double force_n) {
  constexpr double kLastsS = 0.2;
  return {std::move(words),
          {},
          ArmPush{kFaultS, kFaultS + kLastsS, link, {0, force_n, 0}, {0, 0, 0.05}},
          {}};
}

}  // namespace

std::vector<DetectionFault> detection_faults() {
  const auto payload = [](std::string words, double mass_kg) -> DetectionFault {
    return {std::move(words), effect_of(EffectKind::kTipPayload, 6, {mass_kg, 0, 0, 0.15}), {}, {}};
  };
  return {payload("payload 0.5 kg", 0.5),
          payload("payload 0.2 kg", 0.2),
          on_joint("friction +1 N m, joint 4", EffectKind::kCoulombFriction, 3, 1),
          on_joint("friction +1 N m, joint 1", EffectKind::kCoulombFriction, 0, 1),
          on_joint("torque lost 20 %, joint 4", EffectKind::kTorqueScale, 3, 0.25),
          on_joint("torque lost 10 %, joint 2", EffectKind::kTorqueScale, 1, 1 / 0.9 - 1),
          push("push 15 N, link 4", 3, 15),
          push("push 5 N, hand", 6, 5)};
}

desk::RobotDescription owners_robot(std::uint64_t seed) {
  Draws draws(seed, Stream::kKnowledge);
  desk::RobotDescription robot = desk::campaign::with_cad_errors(true_robot(), kCadError, draws);
  for (desk::RobotEffect& effect : robot.effects) {
    if (effect.kind == EffectKind::kRotorInertia) continue;
    effect.parameters[0] *= 1 + kFrictionError * draws.sign();
  }
  return robot;
}

desk::Log arm_recording(std::uint64_t run, double duration_s, const DetectionFault* fault,
                        const std::string& folder) {
  const desk::RobotDescription robot = true_robot();
  ArmRig rig{mujoco_model_of(robot), {}, {}, std::vector<double>(robot.joints.size(), 1.0)};
  if (fault != nullptr && fault->effect) rig.effects.push_back(*fault->effect);
  if (fault != nullptr && fault->push) rig.pushes.push_back(*fault->push);
  Draws motion_draws(run, Stream::kMotion);
  const std::vector<double> middles{0, 0.2, 0, -1.55, 0, 1.8, 0};
  const sim::hidden::ArmMotion motion = sim::hidden::draw_arm_motion(
      middles, std::vector<bool>(middles.size(), false), duration_s, motion_draws);
  const ArmRun happened = run_arm(rig, motion, duration_s, 1);
  std::vector<double> noise_nm;
  for (Eigen::Index j = 0; j < happened.tau.cols(); ++j) {
    noise_nm.push_back(kTorqueNoise * happened.tau.col(j).cwiseAbs().maxCoeff());
  }
  Draws noise(run, Stream::kNoise);
  const ArmLogStyle style{.every = 1, .bits = 19};
  const auto path = std::filesystem::path(folder) / ("run" + std::to_string(run) + ".csv");
  std::ofstream(path) << recording_text(happened, style, noise_nm, noise);
  desk::Log log = desk::read_log(path, robot);
  std::filesystem::remove(path);
  return log;
}

}  // namespace offnominal::bench
