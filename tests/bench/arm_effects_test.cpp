// What the arms of the benchmark hide is what the files' effects mean, although MuJoCo makes it.
#include "arm_effects.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <offnominal/model/effect_list.hpp>

#include "arm_rig.hpp"
#include "arm_robot.hpp"
#include "arm_sketch.hpp"
#include "compare/inverse_model.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

using bench::ArmEffect;
using bench::ArmJointScale;
using bench::ArmRig;
using bench::ArmRun;
using Eigen::Index;
using sim::hidden::ArmMotion;
using sim::hidden::Draws;
using sim::hidden::Stream;

constexpr double kTickS = 0.001;

desk::RobotDescription arm_with_friction() {
  Draws draws(4711, Stream::kArm);
  desk::RobotDescription robot = bench::draw_rigid_arm(draws);
  for (Index j = 0; j < robot.joint_count(); ++j) {
    bench::add_effect(robot, EffectKind::kViscousFriction, j, {1.5});
    bench::add_effect(robot, EffectKind::kCoulombFriction, j, {2.0, 1e-6});
    bench::add_effect(robot, EffectKind::kRotorInertia, j, {0.3});
  }
  return robot;
}

ArmMotion sines(Index joints) {
  ArmMotion motion;
  for (Index j = 0; j < joints; ++j) {
    const auto number = static_cast<double>(j);
    motion.joints.push_back(
        {0.3 - 0.1 * number, {{0.4, 2.0 + 0.3 * number, number}, {0.2, 5.0, 2 * number}}, {}});
  }
  return motion;
}

// Rows well away from any reversal, where a tick tells no direction; before them the run's first,
// from which the model counts the time.
struct Away {
  desk::Motion motion;
  Eigen::MatrixXd tau;
};
Away away_from_reversals(const ArmRun& run) {
  constexpr double kLeastSpeed = 0.1;  // rad/s
  Away away;
  std::vector<Index> rows{0};
  for (Index i = 200; i + 1 < run.t_s.size(); ++i) {
    if (run.dq.row(i).cwiseAbs().minCoeff() > kLeastSpeed) rows.push_back(i);
  }
  const auto count = static_cast<Index>(rows.size());
  const Index joints = run.q.cols();
  away.motion = {Eigen::VectorXd(count), Eigen::MatrixXd(count, joints),
                 Eigen::MatrixXd(count, joints), Eigen::MatrixXd(count, joints)};
  away.tau.resize(count, joints);
  for (Index i = 0; i < count; ++i) {
    const Index at = rows[static_cast<std::size_t>(i)];
    away.motion.t_s[i] = run.t_s[at];
    away.motion.q.row(i) = run.q.row(at);
    away.tau.row(i) = run.tau.row(at);
    if (at == 0) {
      away.motion.dq.row(i).setZero();
      away.motion.ddq.row(i).setZero();
      continue;
    }
    away.motion.dq.row(i) = (run.q.row(at + 1) - run.q.row(at - 1)) / (2 * kTickS);
    away.motion.ddq.row(i) =
        (run.q.row(at + 1) - 2 * run.q.row(at) + run.q.row(at - 1)) / (kTickS * kTickS);
  }
  return away;
}

double rms(const Eigen::Ref<const Eigen::VectorXd>& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

// rms error per joint of a model, N m.
Eigen::VectorXd error_of(const desk::RobotDescription& robot, const Away& away) {
  const Eigen::MatrixXd error = away.tau - desk::model_torque(robot, away.motion);
  Eigen::VectorXd result(error.cols());
  for (Index j = 0; j < error.cols(); ++j) result[j] = rms(error.col(j).tail(error.rows() - 1));
  return result;
}

TEST(ArmRig, MovesAsOurModelOfTheSameArmSays) {
  const desk::RobotDescription robot = arm_with_friction();
  const ArmRig rig{
      bench::mujoco_model_of(robot), {}, {}, std::vector<double>(robot.joints.size(), 1.0)};
  const Away away = away_from_reversals(bench::run_arm(rig, sines(robot.joint_count()), 6, 1));
  ASSERT_GT(away.tau.rows(), 300);
  const Eigen::VectorXd error = error_of(robot, away);
  for (Index j = 0; j < error.size(); ++j) {
    EXPECT_LT(error[j], 0.01 * rms(away.tau.col(j))) << "joint " << j + 1;
  }
}

// The effect as a robot file has it: the same names, the same numbers.
desk::RobotEffect written(const ArmEffect& hidden) {
  desk::RobotEffect effect;
  effect.kind = hidden.kind;
  effect.joint = static_cast<std::uint8_t>(hidden.joint);
  const auto parameters = info_of(hidden.kind)->parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const std::string_view name = parameters[i].name;
    effect.parameters[i] = name == "smoothing" ? 1e-6 : hidden.named(name);
  }
  return effect;
}

class HiddenInAnArm : public testing::TestWithParam<EffectKind> {};

TEST_P(HiddenInAnArm, IsTheEffectOfItsName) {
  const desk::RobotDescription robot = arm_with_friction();
  const Index joints = robot.joint_count();
  ArmJointScale scale{.torque = 20,
                      .load = 20,
                      .speed = 1,
                      .speed2 = 1.5,
                      .acceleration = 3,
                      .middle = 0.2,
                      .spread = 0.3,
                      .coulomb = 2,
                      .viscous = 1.5};
  const std::vector<ArmJointScale> scales(static_cast<std::size_t>(joints), scale);
  constexpr Index kJoint = 1;
  const std::uint64_t seed = test_seed();
  Draws draws(seed, Stream::kEffects);
  const ArmEffect hidden =
      GetParam() == EffectKind::kTipPayload
          ? ArmEffect{EffectKind::kTipPayload,
                      joints - 1,
                      {{"mass", 2.5}, {"x", 0.05}, {"y", -0.02}, {"z", 0.1}},
                      0}
          : bench::draw_arm_effect(GetParam(), kJoint, scales, kJoint + 1, draws);
  desk::RobotDescription with = robot;
  with.effects.push_back(written(hidden));
  const bool in_model = GetParam() == EffectKind::kRotorInertia;
  ArmRig rig{bench::mujoco_model_of(in_model ? with : robot),
             {hidden},
             {},
             std::vector<double>(robot.joints.size(), 1.0)};
  const Away away = away_from_reversals(bench::run_arm(rig, sines(joints), 6, 1));
  ASSERT_GT(away.tau.rows(), 300);
  const double without_it = error_of(robot, away)[kJoint];
  const double with_it = error_of(with, away)[kJoint];
  EXPECT_LT(with_it, 0.1 * without_it);
  EXPECT_LT(with_it, 0.01 * rms(away.tau.col(kJoint)));
}

std::vector<EffectKind> every_kind() {
  std::vector<EffectKind> kinds = bench::arm_effect_kinds();
  kinds.push_back(EffectKind::kTipPayload);
  return kinds;
}

INSTANTIATE_TEST_SUITE_P(All, HiddenInAnArm, testing::ValuesIn(every_kind()),
                         [](const auto& one) { return std::string(info_of(one.param)->name); });

}  // namespace
}  // namespace offnominal::test
