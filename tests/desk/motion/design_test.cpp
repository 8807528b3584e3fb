#include "motion/design.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "motion/design_report.hpp"
#include "robot/robot_file.hpp"
#include "support/repetitions.hpp"
#include "support/robots.hpp"

namespace offnominal::desk::motion {
namespace {

using test::kRobots;

DesignRequest request_for(const RobotDescription& robot, const std::vector<std::string>& effects) {
  DesignRequest request;
  for (const std::string& text : effects) {
    request.effects.push_back(contender_of(text, robot, "--separate"));
  }
  request.duration_s = 15;
  request.rate_hz = 200;
  request.starts = test::repetitions(24) > 1 ? 24 : 12;
  request.threads = 2;
  return request;
}

std::string bytes_of(const RobotDescription& robot, const Design& design) {
  return csv_of(design.fitted.motion) + to_json(robot, design, {}).dump();
}

struct Pair {
  std::string name;
  std::string robot;
  std::vector<std::string> effects;

  // Not its bytes, which hold addresses: a test's name is the same in every run.
  friend void PrintTo(const Pair& pair, std::ostream* out) { *out << pair.name; }
};

class DesignedPair : public ::testing::TestWithParam<Pair> {};

TEST_P(DesignedPair, IsToldApartBetterThanOnASlowSineWithinTheLimits) {
  const RobotDescription robot = read_robot_file(kRobots / GetParam().robot);
  const Design design = design_motion(robot, request_for(robot, GetParam().effects));
  ASSERT_NE(design.worst(), nullptr);
  double before = std::numeric_limits<double>::infinity();
  for (const PairReport& pair : design.pairs) {
    if (pair.possible) before = std::min(before, pair.before.value().evidence);
    EXPECT_GE(pair.after.sine, 0);
    EXPECT_LE(pair.after.sine, 1);
  }
  EXPECT_GT(design.worst()->after.evidence, 1.2 * before);
  EXPECT_GT(design.worst()->after.evidence, 3);
  const Motion& motion = design.fitted.motion;
  ASSERT_EQ(motion.sample_count(), 3001);
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    const JointLimits& limits = design.limits[j];
    EXPECT_GE(motion.q.col(column).minCoeff(), limits.low);
    EXPECT_LE(motion.q.col(column).maxCoeff(), limits.high);
    EXPECT_LE(motion.dq.col(column).cwiseAbs().maxCoeff(), limits.velocity);
    EXPECT_LE(design.fitted.torque.col(column).cwiseAbs().maxCoeff(), limits.torque);
  }
  EXPECT_NEAR(motion.dq.row(0).norm() + motion.dq.row(motion.sample_count() - 1).norm(), 0, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(
    Robots, DesignedPair,
    ::testing::Values(
        Pair{"Friction", "emps.toml", {"coulomb_friction", "viscous_friction"}},
        Pair{"Position", "emps.toml", {"joint_stiffness", "link_mass"}},
        Pair{"TwoJoints", "two_link.toml", {"joint_stiffness@1", "link_mass@2", "torque_offset@1"}},
        Pair{"Velocity", "two_link.toml", {"quadratic_friction@2", "viscous_friction@2"}}),
    [](const auto& pair) { return pair.param.name; });

TEST(Design, IsTheSameForTheSameSeedWhateverTheThreads) {
  const RobotDescription robot = read_robot_file(kRobots / "two_link.toml");
  DesignRequest request = request_for(robot, {"coulomb_friction@1", "viscous_friction@1"});
  request.starts = 6;
  const std::string once = bytes_of(robot, design_motion(robot, request));
  request.threads = 1;
  EXPECT_EQ(bytes_of(robot, design_motion(robot, request)), once);
  request.threads = 5;
  EXPECT_EQ(bytes_of(robot, design_motion(robot, request)), once);
  request.seed = 2;
  EXPECT_NE(bytes_of(robot, design_motion(robot, request)), once);
}

TEST(Design, ImprovesWithMoreTries) {
  const RobotDescription robot = read_robot_file(kRobots / "two_link.toml");
  DesignRequest request = request_for(robot, {"coulomb_friction@1", "viscous_friction@1"});
  request.starts = 1;
  const double one = design_motion(robot, request).worst()->after.evidence;
  request.starts = 30;
  EXPECT_GT(design_motion(robot, request).worst()->after.evidence, one);
}

// On a horizontal axis the mass of the carriage is inertia and nothing else.
TEST(Design, SaysWhereNoMotionTellsTwoEffectsApart) {
  const RobotDescription robot = read_robot_file(kRobots / "emps.toml");
  DesignRequest request = request_for(robot, {"link_mass", "rotor_inertia"});
  request.starts = 8;
  const Design design = design_motion(robot, request);
  EXPECT_EQ(design.worst(), nullptr);
  EXPECT_THAT(sentence_of(robot, design, {}), ::testing::HasSubstr("the same torque"));
}

// A spring at any rest position explains whatever a constant torque does; not the other way about.
TEST(Design, LeavesOutTheDirectionInWhichOneEffectContainsTheOther) {
  const RobotDescription robot = read_robot_file(kRobots / "emps.toml");
  DesignRequest request = request_for(robot, {"torque_offset", "joint_stiffness"});
  request.starts = 8;
  const Design design = design_motion(robot, request);
  ASSERT_EQ(design.pairs.size(), 2U);
  EXPECT_FALSE(design.pairs[0].possible);
  EXPECT_TRUE(design.pairs[1].possible);
  EXPECT_EQ(design.worst(), &design.pairs[1]);
}

TEST(Design, ExcitesEveryJointAndEveryEffectWhenNoneIsNamed) {
  const RobotDescription robot = read_robot_file(kRobots / "two_link.toml");
  const Design design = design_motion(robot, request_for(robot, {}));
  EXPECT_EQ(design.excited, std::vector<bool>(2, true));
  EXPECT_EQ(design.pairs.size(), contenders_on(robot, {0, 1}).size());
}

TEST(Design, ComparesWithTheRecordingsThatCouldNotTell) {
  const RobotDescription robot = read_robot_file(kRobots / "emps.toml");
  DesignRequest request = request_for(robot, {"coulomb_friction", "viscous_friction"});
  request.starts = 8;
  Log log;  // one speed, to and fro
  log.file = "one_speed.csv";
  log.period_s = 0.005;
  log.t_s = Eigen::VectorXd::LinSpaced(4000, 0, 3999 * 0.005);
  log.q = 0.12 + 0.02 / std::asin(0.95) * (0.95 * (2 * log.t_s.array()).sin()).asin();
  log.dq = Eigen::MatrixXd::Zero(4000, 1);
  log.tau = Eigen::MatrixXd::Zero(4000, 1);
  log.dq_derived = {true};
  request.recordings = {log};
  const Design design = design_motion(robot, request);
  for (const PairReport& pair : design.pairs) {
    EXPECT_LT(pair.before.value().sine, pair.after.sine);
    EXPECT_LT(pair.before.value().evidence, pair.after.evidence);
  }
}

TEST(Design, RefusesARobotThatCannotHoldItself) {
  RobotDescription robot = read_robot_file(kRobots / "two_link.toml");
  robot.joints[0].joint.min_position = -0.3;
  robot.joints[0].joint.max_position = 0.3;
  robot.joints[0].joint.max_torque = 1;
  EXPECT_THROW(design_motion(robot, request_for(robot, {})), InputError);
}

}  // namespace
}  // namespace offnominal::desk::motion
