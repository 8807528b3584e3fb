#include "detection_case.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "arm_recording.hpp"
#include "arm_robot.hpp"
#include "arm_sketch.hpp"
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

DetectionFault on_joint(std::string words, EffectKind effect, int joint, double number,
                        FaultKind kind, double size) {
  return {.words = std::move(words),
          .effect = effect_of(effect, joint, {number}),
          .push = {},
          .encoder = {},
          .joint = joint,
          .kind = kind,
          .size = size};
}

DetectionFault friction(int joint, double nm) {
  return on_joint("friction +" + std::to_string(static_cast<int>(nm)) + " N m, joint " +
                      std::to_string(joint + 1),
                  EffectKind::kCoulombFriction, joint, nm, FaultKind::kFriction, nm);
}

DetectionFault lost_torque(int joint, int percent) {
  const double share = percent / 100.0;
  return on_joint(
      "torque lost " + std::to_string(percent) + " %, joint " + std::to_string(joint + 1),
      EffectKind::kTorqueScale, joint, 1 / (1 - share) - 1, FaultKind::kLostTorque, share);
}

DetectionFault offset(int joint, int nm) {
  return on_joint("offset of " + std::to_string(nm) + " N m, joint " + std::to_string(joint + 1),
                  EffectKind::kTorqueOffset, joint, nm, FaultKind::kOffset, -nm);
}

DetectionFault push(std::string words, Eigen::Index link, double force_n) {
  constexpr double kLastsS = 0.2;
  return {.words = std::move(words),
          .effect = {},
          .push = ArmPush{kFaultS, kFaultS + kLastsS, link, {0, force_n, 0}, {0, 0, 0.05}},
          .encoder = {},
          .joint = {},
          .kind = FaultKind::kContact,
          .size = {}};
}

DetectionFault encoder(std::string words, int joint, std::optional<double> jump) {
  return {.words = std::move(words),
          .effect = {},
          .push = {},
          .encoder = EncoderFault{joint, jump},
          .joint = joint,
          .kind = jump ? FaultKind::kEncoderJump : FaultKind::kEncoderStuck,
          .size = jump};
}

DetectionFault payload(std::string words, double mass_kg) {
  return {.words = std::move(words),
          .effect = effect_of(EffectKind::kTipPayload, 6, {mass_kg, 0, 0, 0.15}),
          .push = {},
          .encoder = {},
          .joint = {},
          .kind = FaultKind::kPayload,
          .size = mass_kg};
}

void spoil(const EncoderFault& fault, ArmRun& run) {
  const Eigen::Index first = static_cast<Eigen::Index>(kFaultS * 1000);
  const auto column = static_cast<Eigen::Index>(fault.joint);
  for (Eigen::Index row = first; row < run.q.rows(); ++row) {
    if (fault.jump) {
      run.q(row, column) += *fault.jump;
    } else {
      run.q(row, column) = run.q(first - 1, column);
    }
  }
}

}  // namespace

std::vector<DetectionFault> detection_faults() {
  return {payload("payload 0.5 kg", 0.5),
          payload("payload 0.2 kg", 0.2),
          friction(3, 1),
          friction(0, 1),
          lost_torque(3, 20),
          lost_torque(1, 10),
          push("push 15 N, link 4", 3, 15),
          push("push 5 N, hand", 6, 5)};
}

std::vector<DetectionFault> isolation_faults() {
  std::vector<DetectionFault> faults = detection_faults();
  for (DetectionFault& fault : std::vector{
           payload("payload 1 kg", 1), friction(1, 4), friction(5, 1), lost_torque(5, 30),
           push("push 40 N, link 4", 3, 40), push("push 20 N, hand", 6, 20), offset(3, 3),
           offset(1, 6), encoder("encoder stuck, joint 2", 1, {}),
           encoder("encoder stuck, joint 4", 3, {}), encoder("encoder stuck, joint 6", 5, {}),
           encoder("encoder jump 0.05 rad, joint 2", 1, 0.05),
           encoder("encoder jump 0.02 rad, joint 6", 5, 0.02)}) {
    faults.push_back(std::move(fault));
  }
  return faults;
}

desk::RobotDescription owners_robot(std::uint64_t seed) {
  Draws draws(seed, Stream::kKnowledge);
  desk::RobotDescription robot = with_cad_errors(true_robot(), kCadError, draws);
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
  const ArmMotion motion =
      draw_arm_motion(middles, std::vector<bool>(middles.size(), false), duration_s, motion_draws);
  ArmRun happened = run_arm(rig, motion, duration_s, 1);
  if (fault != nullptr && fault->encoder) spoil(*fault->encoder, happened);
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
