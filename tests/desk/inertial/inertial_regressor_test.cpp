#include "identify/inertial_regressor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>

#include "compare/inverse_model.hpp"
#include "mujoco_plant.hpp"
#include "support/seed.hpp"

// The regressor against core's inverse dynamics, and against MuJoCo's.

namespace offnominal::test {
namespace {

using desk::inertial_numbers_of;
using desk::inertial_regressor;
using desk::RobotDescription;

desk::Motion random_states(const RobotDescription& robot, std::mt19937_64& generator) {
  constexpr Eigen::Index kStates = 200;
  const Eigen::Index joints = robot.joint_count();
  std::uniform_real_distribution<double> draw(-1, 1);
  const auto matrix = [&](double most) {
    return Eigen::MatrixXd(
        Eigen::MatrixXd::NullaryExpr(kStates, joints, [&] { return most * draw(generator); }));
  };
  desk::Motion motion;
  motion.t_s = Eigen::VectorXd::LinSpaced(kStates, 0, 1);
  motion.q = matrix(std::numbers::pi);
  motion.dq = matrix(3);
  motion.ddq = matrix(8);
  return motion;
}

Eigen::MatrixXd torque_by_regressor(const RobotDescription& robot, const desk::Motion& motion) {
  Eigen::MatrixXd torque = Eigen::MatrixXd::Zero(motion.q.rows(), motion.q.cols());
  for (std::size_t link = 0; link < robot.joints.size(); ++link) {
    const auto columns = inertial_regressor(robot, link, motion);
    const desk::InertialNumbers numbers = inertial_numbers_of(robot.joints[link].joint);
    EXPECT_EQ(columns.size(), 10U);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      torque += numbers[static_cast<Eigen::Index>(i)] * columns[i];
    }
  }
  return torque;
}

RobotDescription with_a_slide(RobotDescription robot) {
  robot.joints.back().joint.type = JointType::kPrismatic;
  return robot;
}

class InertialRegressor : public testing::TestWithParam<std::size_t> {};

TEST_P(InertialRegressor, TimesTheLinksNumbersIsCoresInverseDynamics) {
  std::mt19937_64 generator = seeded_generator();
  for (const RobotDescription& robot :
       {plain_arm(GetParam()), with_a_slide(plain_arm(GetParam()))}) {
    const desk::Motion motion = random_states(robot, generator);
    const Eigen::MatrixXd model = desk::model_torque(robot, motion);
    const double error = (torque_by_regressor(robot, motion) - model).cwiseAbs().maxCoeff();
    EXPECT_LT(error, 1e-11 * model.cwiseAbs().maxCoeff());
  }
}

TEST_P(InertialRegressor, TimesTheLinksNumbersIsMujocosInverseDynamics) {
  std::mt19937_64 generator = seeded_generator();
  const RobotDescription robot = plain_arm(GetParam());
  const desk::Motion motion = random_states(robot, generator);
  MujocoPlant plant(robot, plain_drives(GetParam()));
  const Eigen::MatrixXd torque = torque_by_regressor(robot, motion);
  double worst = 0;
  for (Eigen::Index i = 0; i < motion.q.rows(); ++i) {
    const Eigen::VectorXd theirs = plant.rigid(
        motion.q.row(i).transpose(), motion.dq.row(i).transpose(), motion.ddq.row(i).transpose());
    worst = std::max(worst, (torque.row(i).transpose() - theirs).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(worst, 1e-6 * torque.cwiseAbs().maxCoeff());
}

INSTANTIATE_TEST_SUITE_P(Arms, InertialRegressor, testing::Values(1, 2, 6, 7));

TEST(InertialRegressorOfALink, IsNothingToJointsBehindIt) {
  std::mt19937_64 generator = seeded_generator();
  const RobotDescription robot = plain_arm(3);
  const auto columns = inertial_regressor(robot, 1, random_states(robot, generator));
  for (const Eigen::MatrixXd& one : columns) EXPECT_EQ(one.col(2).cwiseAbs().maxCoeff(), 0);
}

}  // namespace
}  // namespace offnominal::test
