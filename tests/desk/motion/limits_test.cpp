#include "motion/limits.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <offnominal/sim/hidden/draw_robot.hpp>

#include "common/error.hpp"
#include "compare/inverse_model.hpp"
#include "desk/explain/hidden_case.hpp"
#include "motion/plan_space.hpp"
#include "robot/robot_file.hpp"
#include "support/repetitions.hpp"
#include "support/robots.hpp"
#include "support/seed.hpp"

namespace offnominal::desk::motion {
namespace {

using Eigen::Index;
using ::testing::HasSubstr;

using test::kRobots;

std::vector<RobotDescription> robots() {
  std::vector<RobotDescription> all{read_robot_file(kRobots / "emps.toml"),
                                    read_robot_file(kRobots / "two_link.toml")};
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    sim::hidden::Request request;
    request.seed = seed;
    all.push_back(test::to_robot(sim::hidden::draw_robot(request).nominal));
  }
  // A drive that can just about hold the arm.
  all.push_back(all[1]);
  all.back().joints[0].joint.max_torque = 60;
  all.back().joints[1].joint.max_torque = 25;
  return all;
}

void expect_within(const RobotDescription& robot, const FittedMotion& fitted, double margin) {
  const Eigen::MatrixXd torque = model_torque(robot, fitted.motion);
  EXPECT_EQ(torque, fitted.torque);
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const Joint<double>& joint = robot.joints[j].joint;
    const auto column = static_cast<Index>(j);
    const double left = margin * (joint.max_position - joint.min_position) / 2;
    EXPECT_GE(fitted.motion.q.col(column).minCoeff(), joint.min_position + left);
    EXPECT_LE(fitted.motion.q.col(column).maxCoeff(), joint.max_position - left);
    EXPECT_LE(fitted.motion.dq.col(column).cwiseAbs().maxCoeff(),
              (1 - margin) * joint.max_velocity);
    EXPECT_LE(torque.col(column).cwiseAbs().maxCoeff(), (1 - margin) * joint.max_torque);
  }
}

TEST(FitIntoLimits, KeepsEveryLimitOfEveryRobotAtEverySample) {
  const std::uint64_t seed = test::test_seed();
  SCOPED_TRACE(seed);
  for (const RobotDescription& robot : robots()) {
    SCOPED_TRACE(robot.name);
    const PlanSpace space(robot.joints.size(), 20);
    int fitting = 0;
    const int tries = test::repetitions(20);
    for (int i = 0; i < tries; ++i) {
      const double margin = i % 2 == 0 ? 0 : 0.25;
      const auto fitted = fit_into_limits(
          robot, space.plan_at(space.random_point(seed + static_cast<std::uint64_t>(i))),
          limits_of(robot, margin), 20, 250);
      if (!fitted) continue;
      ++fitting;
      expect_within(robot, *fitted, margin);
    }
    EXPECT_GE(2 * fitting, tries);
  }
}

// A motion that keeps to a tenth of what it may is no excitation.
TEST(FitIntoLimits, UsesWhatThereIs) {
  const RobotDescription robot = read_robot_file(kRobots / "emps.toml");
  const PlanSpace space(1, 20);
  MotionPlan plan = space.plan_at(space.random_point(1));
  plan.joints[0].reach = 1;
  plan.joints[0].home = 0;
  const auto limits = limits_of(robot, 0);
  const auto fitted = fit_into_limits(robot, plan, limits, 20, 250);
  ASSERT_TRUE(fitted);
  const auto q = fitted->motion.q.col(0);
  const double use = std::max({(q.maxCoeff() - limits[0].middle()) / limits[0].half_range(),
                               (limits[0].middle() - q.minCoeff()) / limits[0].half_range(),
                               fitted->motion.dq.cwiseAbs().maxCoeff() / limits[0].velocity,
                               fitted->torque.cwiseAbs().maxCoeff() / limits[0].torque});
  EXPECT_GT(use, 0.98);
}

TEST(FitIntoLimits, GivesUpWhereTheModelCannotHoldTheArm) {
  RobotDescription robot = read_robot_file(kRobots / "two_link.toml");
  robot.joints[0].joint.min_position = -0.3;  // about horizontal
  robot.joints[0].joint.max_position = 0.3;
  robot.joints[0].joint.max_torque = 1;
  const PlanSpace space(2, 20);
  EXPECT_FALSE(
      fit_into_limits(robot, space.plan_at(space.random_point(1)), limits_of(robot, 0.1), 20, 100));
}

TEST(LimitsOf, RefusesARobotWithoutLimits) {
  const auto refusal = [](const auto& remove) {
    RobotDescription robot = read_robot_file(kRobots / "two_link.toml");
    remove(robot.joints[1].joint);
    try {
      static_cast<void>(limits_of(robot, 0.1));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  constexpr double kNone = std::numeric_limits<double>::max();
  EXPECT_THAT(refusal([](auto& joint) { joint.max_position = kNone; }), HasSubstr("joint 2"));
  EXPECT_THAT(refusal([](auto& joint) { joint.min_position = -kNone; }), HasSubstr("position"));
  EXPECT_THAT(refusal([](auto& joint) { joint.max_velocity = kNone; }), HasSubstr("velocity"));
  EXPECT_THAT(refusal([](auto& joint) { joint.max_torque = kNone; }), HasSubstr("torque"));
}

}  // namespace
}  // namespace offnominal::desk::motion
