#include "compare/inverse_model.hpp"

#include <gtest/gtest.h>

#include <offnominal/model/effect_memory.hpp>
#include <offnominal/model/inverse_dynamics.hpp>
#include <random>

#include "compare/measurement.hpp"
#include "identify/unknown.hpp"
#include "recorded_arm.hpp"
#include "robot/chain_of.hpp"
#include "support/seed.hpp"

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using offnominal::EffectInfo;
using offnominal::kAllEffectInfos;
using offnominal::ParameterInfo;
using offnominal::test::arm_description;
using offnominal::test::arm_motion;
using offnominal::test::effect_of;
using offnominal::test::record_arm;
using namespace offnominal::desk;

// The arm's motion without any filter.
Motion exact_motion(Index samples) {
  Motion motion{VectorXd(samples), MatrixXd(samples, 2), MatrixXd(samples, 2),
                MatrixXd(samples, 2)};
  for (Index i = 0; i < samples; ++i) {
    const auto at = arm_motion(0.05 * static_cast<double>(i), 1);
    motion.t_s[i] = at.t_s;
    motion.q.row(i) = at.q;
    motion.dq.row(i) = at.dq;
    motion.ddq.row(i) = at.ddq;
  }
  return motion;
}

TEST(InverseModel, EqualsTheClosedFormArm) {
  const Motion motion = exact_motion(200);
  const MatrixXd torque = model_torque(arm_description(), motion);
  const offnominal::sim::TwoLinkParameters arm;
  for (Index i = 0; i < 200; ++i) {
    const Eigen::Vector2d q = motion.q.row(i);
    const Eigen::Vector2d dq = motion.dq.row(i);
    const Eigen::Vector2d ddq = motion.ddq.row(i);
    const Eigen::Vector2d expected = offnominal::sim::mass_matrix(arm, q) * ddq +
                                     offnominal::sim::velocity_torque(arm, {q, dq}) +
                                     offnominal::sim::gravity_torque(arm, q);
    EXPECT_LT((torque.row(i).transpose() - expected).norm(), 1e-11);
  }
}

TEST(InverseModel, LinksAddUpToTheRigidBodyTorque) {
  const Motion motion = exact_motion(50);
  const RobotDescription robot = arm_description();
  const MatrixXd sum = link_torque(robot, 0, motion) + link_torque(robot, 1, motion);
  EXPECT_LT((sum - model_torque(robot, motion)).cwiseAbs().maxCoeff(), 1e-11);
}

// For every effect but a delay: torque with it = torque without it + sum of parameter * regressor.
TEST(InverseModel, EveryEffectIsLinearInItsRegressors) {
  auto generator = offnominal::test::seeded_generator();
  std::uniform_real_distribution<double> number(0.1, 2);
  const Motion motion = exact_motion(60);
  for (const EffectInfo& info : kAllEffectInfos) {
    if (info.kind == offnominal::EffectKind::kTimeDelay) continue;
    for (const int joint : {0, 1}) {
      RobotDescription robot = arm_description();
      robot.effects.push_back(effect_of(info.kind, joint, {}));
      auto& parameters = robot.effects[0].parameters;
      for (std::size_t i = 0; i < info.parameters.size(); ++i) {
        const bool other_joint = info.parameters[i].quantity == offnominal::Quantity::kJointNumber;
        parameters[i] = other_joint ? 2 - joint : number(generator);
      }
      MatrixXd expected = model_torque(arm_description(), motion);
      for (const Unknown& unknown : unknowns_of_effect(robot, 0, true)) {
        for (const JointColumn& column : regressor(robot, unknown, motion)) {
          expected.col(static_cast<Index>(column.joint)) += unknown.start * column.values;
        }
      }
      EXPECT_LT((model_torque(robot, motion) - expected).cwiseAbs().maxCoeff(), 1e-10)
          << info.name << " on joint " << joint + 1;
    }
  }
}

Unknown scale_of(std::size_t link) {
  Unknown unknown;
  unknown.kind = Unknown::Kind::kLinkScale;
  unknown.joint = link;
  return unknown;
}

RobotDescription heavier_arm(RobotDescription robot, double first, double second) {
  for (std::size_t link = 0; link < 2; ++link) {
    auto& joint = robot.joints[link].joint;
    const double factor = 1 + (link == 0 ? first : second);
    joint.mass_kg *= factor;
    for (double& inertia : joint.inertia_kg_m2) inertia *= factor;
  }
  return robot;
}

// A memory that sees robot after robot has nothing left of those before.
TEST(InverseModel, IsCoresToTheBitWhateverRobotCameBefore) {
  auto generator = offnominal::test::seeded_generator();
  std::uniform_real_distribution<double> number(0.1, 2);
  const Motion motion = exact_motion(60);
  RobotDescription robot = arm_description();
  robot.transmission.emplace().matrix = {{30, 0}, {20, 20}};
  BodyTorque memory;
  for (int round = 0; round < 2; ++round) {
    for (const EffectInfo& info : kAllEffectInfos) {
      for (const bool of_motor : {false, true}) {
        const bool remembers =
            offnominal::remembers(info.kind) || info.kind == offnominal::EffectKind::kTimeDelay;
        if (remembers || (of_motor && !offnominal::motor_may_have(info.kind))) continue;
        RobotDescription with = heavier_arm(robot, 0.1 * round, 0);
        with.effects = {effect_of(offnominal::EffectKind::kRotorInertia, 0, {number(generator)}),
                        effect_of(info.kind, 1, {})};
        with.effects[1].of_motor = of_motor;
        for (std::size_t i = 0; i < info.parameters.size(); ++i) {
          const bool other = info.parameters[i].quantity == offnominal::Quantity::kJointNumber;
          with.effects[1].parameters[i] = other ? 1 : number(generator);
        }
        const MatrixXd torque = model_torque(with, motion, memory);
        const auto model =
            offnominal::make_model(chain_of<offnominal::kRuntimeJoints, double>(with));
        using Joints = offnominal::Vector<offnominal::kRuntimeJoints, double>;
        for (Index i = 0; i < motion.sample_count(); ++i) {
          const Joints expected = offnominal::inverse_dynamics<offnominal::kRuntimeJoints, double>(
              model, Joints(motion.q.row(i)), Joints(motion.dq.row(i)), Joints(motion.ddq.row(i)),
              motion.t_s[i] - motion.t_s[0]);
          ASSERT_EQ(torque(i, 0), expected[0]) << info.name << ' ' << of_motor;
          ASSERT_EQ(torque(i, 1), expected[1]) << info.name << ' ' << of_motor;
        }
      }
    }
  }
}

TEST(InverseModel, ScaledLinkIsItsRegressorMore) {
  const Motion motion = exact_motion(60);
  const RobotDescription robot = arm_description();
  const RobotDescription changed = heavier_arm(robot, 0.2, -0.1);
  MatrixXd expected = model_torque(robot, motion);
  for (std::size_t link = 0; link < 2; ++link) {
    for (const JointColumn& column : regressor(robot, scale_of(link), motion)) {
      expected.col(static_cast<Index>(column.joint)) += (link == 0 ? 0.2 : -0.1) * column.values;
    }
  }
  EXPECT_LT((model_torque(changed, motion) - expected).cwiseAbs().maxCoeff(), 1e-11);
}

RobotDescription delayed_arm(double delay_s) {
  RobotDescription robot = arm_description();
  robot.effects.push_back(effect_of(offnominal::EffectKind::kTorqueScale, 1, {0.25}));
  robot.effects.push_back(effect_of(offnominal::EffectKind::kTimeDelay, 1, {delay_s}));
  return robot;
}

TEST(InverseModel, ADelayedDriveIsToldEarlier) {
  const Motion motion = exact_motion(60);  // every 0.05 s
  const MatrixXd prompt = model_torque(delayed_arm(0), motion);
  const MatrixXd late = model_torque(delayed_arm(0.15), motion);
  EXPECT_EQ(late.col(0), prompt.col(0));
  EXPECT_LT((late.col(1).head(57) - prompt.col(1).tail(57)).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(InverseModel, ADelayedDrivesColumnsAreEarlierTooAndTheDelaysIsItsSlope) {
  const Motion motion = exact_motion(60);
  const RobotDescription robot = delayed_arm(0.12);
  const MatrixXd heavier = model_torque(heavier_arm(robot, 0, 0.1), motion);
  const MatrixXd change = heavier - model_torque(robot, motion);
  for (const JointColumn& column : regressor(robot, scale_of(1), motion)) {
    const VectorXd expected = change.col(static_cast<Index>(column.joint));
    EXPECT_LT((0.1 * column.values - expected).cwiseAbs().maxCoeff(), 1e-9);
  }
  const auto delay = unknowns_of_effect(robot, 1, true);
  ASSERT_EQ(delay.size(), 1U);
  const auto columns = regressor(robot, delay[0], motion);
  ASSERT_EQ(columns.size(), 1U);
  const VectorXd slope =
      (model_torque(delayed_arm(0.121), motion) - model_torque(delayed_arm(0.119), motion)).col(1) /
      0.002;
  const double size = slope.cwiseAbs().maxCoeff();
  EXPECT_LT((columns[0].values - slope).segment(5, 50).cwiseAbs().maxCoeff(), 0.02 * size);
}

TEST(InverseModel, NumberOfJointsMustAgree) {
  RobotDescription robot = arm_description();
  robot.joints.pop_back();
  EXPECT_THROW(model_torque(robot, exact_motion(5)), std::invalid_argument);
}

}  // namespace
