#include "studio/arm.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <vector>

#include "common/refused.hpp"
#include "desk/studio/studio_input.hpp"
#include "desk/support/temporary_folder.hpp"
#include "robot/chain_of.hpp"
#include "studio/link_frames.hpp"
#include "support/seed.hpp"

namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using nlohmann::ordered_json;
using offnominal::JointType;
using offnominal::make_model;
using offnominal::test::studio_input;
using offnominal::test::TemporaryFolder;
using namespace offnominal::desk;
using namespace offnominal::desk::studio;
using ::testing::ElementsAre;

RobotDescription random_arm(std::mt19937_64& generator, std::size_t joints) {
  std::normal_distribution<double> normal;
  const auto some = [&] {
    return Vector3d(normal(generator), normal(generator), normal(generator));
  };
  RobotDescription robot;
  robot.name = "any";
  for (std::size_t i = 0; i < joints; ++i) {
    RobotJoint named;
    offnominal::Joint<double>& joint = named.joint;
    joint.type = normal(generator) > 0.5 ? JointType::kPrismatic : JointType::kRevolute;
    Eigen::Map<Vector3d>(joint.axis.data()) = some().normalized();
    Eigen::Map<Vector3d>(joint.origin_m.data()) = some();
    const Eigen::Quaterniond turn =
        Eigen::AngleAxisd(normal(generator), some().normalized()) * Eigen::Quaterniond::Identity();
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(joint.rotation.data()) =
        turn.toRotationMatrix();
    robot.joints.push_back(named);
  }
  return robot;
}

// What robot-file.md says of a joint, by other means than the core's.
Isometry3d frame_by_hand(const RobotDescription& robot, const VectorXd& q, std::size_t last) {
  Isometry3d frame = Isometry3d::Identity();
  for (std::size_t i = 0; i <= last; ++i) {
    const offnominal::Joint<double>& joint = robot.joints[i].joint;
    const Vector3d axis(joint.axis[0], joint.axis[1], joint.axis[2]);
    frame.translate(Vector3d(joint.origin_m[0], joint.origin_m[1], joint.origin_m[2]));
    frame.rotate(
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(joint.rotation.data()));
    const double at = q[static_cast<Eigen::Index>(i)];
    if (joint.type == JointType::kRevolute) frame.rotate(Eigen::AngleAxisd(at, axis));
    if (joint.type == JointType::kPrismatic) frame.translate(at * axis);
  }
  return frame;
}

TEST(StudioArmFrames, AreThoseOfTheRobotFile) {
  std::mt19937_64 generator = offnominal::test::seeded_generator();
  std::uniform_real_distribution<double> angle(-3, 3);
  for (std::size_t joints = 1; joints <= 12; ++joints) {
    const RobotDescription robot = random_arm(generator, joints);
    VectorXd q(static_cast<Eigen::Index>(joints));
    for (double& value : q) value = angle(generator);
    const auto frames =
        link_frames(make_model(chain_of<offnominal::kRuntimeJoints, double>(robot)), q);
    ASSERT_EQ(frames.size(), joints);
    for (std::size_t i = 0; i < joints; ++i) {
      EXPECT_TRUE(frames[i].isApprox(frame_by_hand(robot, q, i), 1e-12)) << joints << ", " << i;
    }
  }
}

TEST(StudioArmShape, EndsWhereTheNextJointIsAndTheLastAsARodWould) {
  RobotDescription robot = offnominal::test::arm_description();
  const VectorXd none = VectorXd::Zero(2);
  // A point mass is the end itself.
  ArmShape shape = shape_of(robot, none, none);
  EXPECT_EQ(shape.links[0].end_m, Vector3d(1, 0, 0));
  EXPECT_EQ(shape.links[1].end_m, Vector3d(1, 0, 0));
  EXPECT_DOUBLE_EQ(shape.reach_m, 2);
  EXPECT_TRUE(shape.knows_lengths);
  // A rod of 0.8 m along y, held at its end.
  offnominal::Joint<double>& last = robot.joints[1].joint;
  last.centre_of_mass_m = {0, 0.4, 0};
  const double across = last.mass_kg * 0.8 * 0.8 / 12;
  last.inertia_kg_m2 = {across, 0, across, 0, 0, 0};
  shape = shape_of(robot, none, none);
  EXPECT_TRUE(shape.links[1].end_m.isApprox(Vector3d(0, 0.8, 0), 1e-12));
  // Nothing is known of it: a pointer, square to the axis.
  last.centre_of_mass_m = {0, 0, 0};
  last.inertia_kg_m2 = {};
  shape = shape_of(robot, none, none);
  EXPECT_NEAR(shape.links[1].end_m.norm(), 0.25, 1e-12);
  EXPECT_NEAR(shape.links[1].end_m.z(), 0, 1e-12);
}

TEST(StudioArmShape, IsAPointerWhereTheFileSaysNoLengthAtAll) {
  RobotDescription robot = offnominal::test::arm_description();
  for (RobotJoint& named : robot.joints) {
    named.joint.origin_m = {0, 0, 0};
    named.joint.centre_of_mass_m = {0, 0, 0};
  }
  const ArmShape shape = shape_of(robot, VectorXd::Zero(2), VectorXd::Zero(2));
  EXPECT_FALSE(shape.knows_lengths);
  EXPECT_EQ(shape.reach_m, 1);
  EXPECT_NEAR(shape.links[1].end_m.norm(), 0.25, 1e-12);
}

TEST(StudioArmShape, HasARailForAPrismaticJoint) {
  RobotDescription robot = offnominal::test::arm_description();
  robot.joints[1].joint.type = JointType::kPrismatic;
  robot.joints[1].joint.rotation = {0, 0, 1, 1, 0, 0, 0, 1, 0};  // its z is the x before it
  robot.joints[1].joint.centre_of_mass_m = {0, 0, 0};
  const ArmShape shape = shape_of(robot, Eigen::Vector2d(0, -0.2), Eigen::Vector2d(0, 0.5));
  EXPECT_FALSE(shape.links[0].rail_m.has_value());
  ASSERT_TRUE(shape.links[1].rail_m.has_value());
  EXPECT_TRUE(shape.links[1].rail_m->first.isApprox(Vector3d(0.8, 0, 0), 1e-12));
  EXPECT_TRUE(shape.links[1].rail_m->second.isApprox(Vector3d(1.5, 0, 0), 1e-12));
  EXPECT_EQ(shape.links[1].end_m, Vector3d(0, 0, 0));
}

class StudioArm : public ::testing::Test {
 protected:
  static std::vector<double> values(const ordered_json& list) {
    return list.get<std::vector<double>>();
  }

  TemporaryFolder folder_;
  Workbench bench_{studio_input(folder_ / "arm.toml", true)};
};

TEST_F(StudioArm, StandsWhereTheClosedFormOfTheTwoLinkArmHasIt) {
  const ordered_json arm = arm_of(bench_, {});
  const auto t_s = values(arm.at("t_s"));
  ASSERT_GT(t_s.size(), 300U);
  const auto q1 = values(arm.at("position").at(0));
  const auto q2 = values(arm.at("position").at(1));
  const auto elbow = values(arm.at("place_m").at(1));
  const auto turn = values(arm.at("turn").at(1));
  for (std::size_t i = 0; i < t_s.size(); ++i) {
    ASSERT_NEAR(elbow[3 * i], std::cos(q1[i]), 2e-6);
    ASSERT_NEAR(elbow[3 * i + 1], std::sin(q1[i]), 2e-6);
    ASSERT_NEAR(elbow[3 * i + 2], 0, 1e-9);
    const Eigen::Quaterniond of_forearm(turn[4 * i + 3], turn[4 * i], turn[4 * i + 1],
                                        turn[4 * i + 2]);
    ASSERT_NEAR((of_forearm * Vector3d::UnitX())
                    .dot(Vector3d(std::cos(q1[i] + q2[i]), std::sin(q1[i] + q2[i]), 0)),
                1, 1e-5);
  }
  EXPECT_THAT(values(arm.at("joints").at(1).at("end_m")), ElementsAre(1, 0, 0));
  EXPECT_EQ(arm.at("over_bound"), nullptr);
}

TEST_F(StudioArm, IsThinnedEvenlyFromTheFirstSampleToTheLast) {
  const Eigen::VectorXd& kept = bench_.now().fitted.recordings[0].t_s;
  EXPECT_EQ(arm_of(bench_, {}).at("t_s").size(), static_cast<std::size_t>(kept.size()));
  const auto t_s = values(arm_of(bench_, {.instants = 100}).at("t_s"));
  ASSERT_EQ(t_s.size(), 100U);
  EXPECT_NEAR(t_s.front(), kept[0], 1e-5);
  EXPECT_NEAR(t_s.back(), kept[kept.size() - 1], 1e-5);
  const double even = (t_s.back() - t_s.front()) / 99;
  const double period = (kept[kept.size() - 1] - kept[0]) / static_cast<double>(kept.size() - 1);
  for (std::size_t i = 1; i < t_s.size(); ++i) {
    EXPECT_NEAR(t_s[i] - t_s[i - 1], even, 1.01 * period) << i;
  }
}

// What is said of the whole recording is what `compare` says, and it follows the part shown.
TEST_F(StudioArm, SaysTheErrorOfThePartThatIsShown) {
  const Comparison& recording = bench_.now().fitted.recordings[0];
  const ordered_json whole = arm_of(bench_, {});
  for (const std::size_t joint : {0U, 1U}) {
    EXPECT_NEAR(whole.at("joints").at(joint).at("error_percent").get<double>(),
                recording.joints[joint].relative_error_percent, 1e-4);
  }
  const ordered_json part = arm_of(bench_, {.instants = 50, .from_s = 4, .to_s = 6});
  const auto t_s = values(part.at("t_s"));
  EXPECT_EQ(t_s.size(), 50U);
  EXPECT_GE(t_s.front(), 4);
  EXPECT_LT(t_s.back(), 6);
  double squares = 0;
  double count = 0;
  for (Eigen::Index i = 0; i < recording.t_s.size(); ++i) {
    if (recording.t_s[i] < 4 || recording.t_s[i] >= 6 || recording.moving(i, 1) == 0) continue;
    squares += std::pow(recording.measured(i, 1) - recording.model(i, 1), 2);
    ++count;
  }
  const double share = part.at("percent").at(1).at(7).get<double>();
  EXPECT_NEAR(
      share,
      100 * std::abs(part.at("error").at(1).at(7).get<double>()) / recording.joints[1].rms_torque,
      1e-4);
  const double rms = part.at("joints").at(1).at("rms_error").get<double>();
  EXPECT_NEAR(rms, std::sqrt(squares / count), 1e-5);
  EXPECT_EQ(part.at("joints").at(1).at("rms_torque"), whole.at("joints").at(1).at("rms_torque"));
}

TEST_F(StudioArm, ShowsAHeldOutRecordingAndTheModelOfNow) {
  const ordered_json as_read = arm_of(bench_, {.recording = 1});
  EXPECT_EQ(as_read.at("recording"), 2);
  const auto percent = [](const ordered_json& arm) {
    return arm.at("joints").at(1).at("error_percent").get<double>();
  };
  EXPECT_NEAR(percent(as_read), bench_.now().held_out->joints[1].relative_error_percent, 1e-4);
  bench_.add(offnominal::EffectKind::kViscousFriction, 1);
  EXPECT_LT(percent(arm_of(bench_, {.recording = 1})), 0.9 * percent(as_read));
}

TEST_F(StudioArm, ShowsTheOneSampleOfATooNarrowPart) {
  const Eigen::VectorXd& t_s = bench_.now().fitted.recordings[0].t_s;
  const double gap = t_s[101] - t_s[100];
  for (const double share : {0.4, 0.6}) {
    const double middle = t_s[100] + share * gap;
    const ordered_json near =
        arm_of(bench_, {.from_s = middle - 0.1 * gap, .to_s = middle + 0.1 * gap});
    ASSERT_EQ(near.at("t_s").size(), 1U);
    EXPECT_NEAR(near.at("t_s").at(0).get<double>(), t_s[share < 0.5 ? 100 : 101], 1e-5);
  }
  const ordered_json arm = arm_of(bench_, {.from_s = -2, .to_s = -1});
  ASSERT_EQ(arm.at("t_s").size(), 1U);
  EXPECT_NEAR(arm.at("t_s").at(0).get<double>(), t_s[0], 1e-5);
  EXPECT_EQ(arm.at("place_m").at(1).size(), 3U);
  // Beyond the end, the last one.
  EXPECT_EQ(arm_of(bench_, {.from_s = 1e9, .to_s = 2e9}).at("t_s").size(), 1U);
}

TEST(StudioArmBound, IsOfTheErrorsTorqueOrOfItsAcceleration) {
  const TemporaryFolder folder;
  Input input = studio_input(folder / "arm.toml", false);
  input.robot.bound.emplace();
  input.robot.bound->kind = BoundSettings::Kind::kPerJoint;
  input.robot.bound->joints = {{{}, {2.0}, 0}, {{0.0, 1.0}, {0.5, 1.5}, 0}};
  const Workbench torques(input);
  const ordered_json arm = arm_of(torques, {.instants = 100});
  input.robot.bound->kind = BoundSettings::Kind::kConstant;
  input.robot.bound->constant.value = 3;
  const Workbench accelerations(input);
  const ordered_json other = arm_of(accelerations, {.instants = 100});
  const offnominal::sim::TwoLinkParameters two_link{};
  const auto at = [](const ordered_json& from, const char* what, std::size_t joint, std::size_t i) {
    return from.at(what).at(joint).at(i).get<double>();
  };
  for (std::size_t i = 0; i < 100; ++i) {
    const Eigen::Vector2d e(at(arm, "error", 0, i), at(arm, "error", 1, i));
    EXPECT_NEAR(at(arm, "over_bound", 0, i), std::abs(e[0]) / 2, 1e-5);
    // At rest 0.5 N m, from 1 rad/s on 1.5 N m.
    EXPECT_GE(at(arm, "over_bound", 1, i), std::abs(e[1]) / 1.5 * (1 - 1e-5));
    EXPECT_LE(at(arm, "over_bound", 1, i), std::abs(e[1]) / 0.5 * (1 + 1e-5));
    const Eigen::Vector2d q(at(other, "position", 0, i), at(other, "position", 1, i));
    const Eigen::Vector2d a = offnominal::sim::mass_matrix(two_link, q).inverse() * e;
    EXPECT_NEAR(at(other, "over_bound", 0, i), std::abs(a[0]) / 3, 1e-4);
    EXPECT_NEAR(at(other, "over_bound", 1, i), std::abs(a[1]) / 3, 1e-4);
  }
}

TEST_F(StudioArm, RefusesWhatIsNotThere) {
  for (const ArmView& view :
       {ArmView{.recording = 2}, ArmView{.recording = static_cast<std::size_t>(-1)},
        ArmView{.from_s = 6, .to_s = 4}, ArmView{.from_s = 5, .to_s = 5}}) {
    EXPECT_THROW(arm_of(bench_, view), Refused);
  }
}

}  // namespace
