#include "inertial/base_parameters.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "desk/exchange/urdfs.hpp"
#include "exchange/import_urdf.hpp"
#include "identify/inertial_regressor.hpp"
#include "inertial/drive_model.hpp"
#include "mujoco_plant.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

using desk::BaseParameters;
using desk::BaseRequest;
using desk::RobotDescription;

BaseRequest whole(const RobotDescription& robot) {
  BaseRequest request;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    request.links.push_back(i);
    request.moves.push_back(1);
    request.stands_at.push_back(0);
  }
  return request;
}

TEST(BaseParameters, OfAPendulumAreItsInertiaAndItsFirstMoments) {
  RobotDescription robot = plain_arm(1);
  robot.joints[0].joint.axis = {0, 1, 0};
  const BaseParameters base = base_parameters(robot, whole(robot));
  EXPECT_THAT(base.names, testing::UnorderedElementsAre("Iyy1", "hx1", "hz1"));
}

TEST(BaseParameters, OfAPlanarArmNameWhatTheFirstLinkCarriesOfTheSecond) {
  RobotDescription robot = plain_arm(2);
  for (desk::RobotJoint& one : robot.joints) one.joint.axis = {0, 1, 0};
  robot.joints[1].joint.origin_m = {0.5, 0, 0};
  const BaseParameters base = base_parameters(robot, whole(robot));
  EXPECT_THAT(base.names, testing::UnorderedElementsAre("Iyy1 + 0.25 m2", "hx1 + 0.5 m2", "hz1",
                                                        "Iyy2", "hx2", "hz2"));
}

// W. Khalil, E. Dombre, Modeling, Identification and Control of Robots, 2002: a serial arm of n
// revolute joints, the first vertical and the second at a right angle, has 7n - 6 of the links at
// most, one less per pair of parallel axes.
TEST(BaseParameters, OfRealArmsAreAsManyAsTheFieldCounts) {
  for (const UrdfCase& one : all_urdfs()) {
    if (one.name != "Panda" && one.name != "Ur5") continue;
    OFFNOMINAL_SKIP_WITHOUT(one);
    const RobotDescription robot =
        desk::exchange::import_urdf(one.text(), one.file.string(), one.chain()).robot;
    EXPECT_EQ(base_parameters(robot, whole(robot)).count(), one.name == "Panda" ? 43 : 36)
        << one.name;
  }
}

TEST(BaseParameters, AreAllThatTorquesDependOn) {
  std::mt19937_64 generator = seeded_generator();
  const RobotDescription robot = plain_arm(3);
  const BaseParameters base = base_parameters(robot, whole(robot));
  // A change of the links' numbers that changes no base parameter changes no torque.
  const Eigen::MatrixXd kernel = base.combinations.fullPivLu().kernel();
  std::normal_distribution<double> draw(0, 1);
  const Eigen::VectorXd change =
      kernel * Eigen::VectorXd::NullaryExpr(kernel.cols(), [&] { return draw(generator); });
  desk::Motion motion;
  motion.t_s = Eigen::VectorXd::LinSpaced(50, 0, 1);
  for (Eigen::MatrixXd* one : {&motion.q, &motion.dq, &motion.ddq}) {
    *one = Eigen::MatrixXd::NullaryExpr(50, 3, [&] { return 2 * draw(generator); });
  }
  Eigen::MatrixXd torque = Eigen::MatrixXd::Zero(50, 3);
  for (std::size_t link = 0; link < 3; ++link) {
    const auto columns = desk::inertial_regressor(robot, link, motion);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      torque += change[static_cast<Eigen::Index>(10 * link + i)] * columns[i];
    }
  }
  EXPECT_GT(change.norm(), 1);
  EXPECT_LT(torque.cwiseAbs().maxCoeff(), 1e-6);
}

TEST(BaseParameters, CannotTellTheFirstRotorFromTheLink) {
  const RobotDescription robot = plain_arm(3);
  BaseRequest request = whole(robot);
  request.rotors = {0, 1, 2};
  EXPECT_THAT(desk::rotors_apart(robot, request), testing::Not(testing::Contains(0)));
  EXPECT_THAT(desk::rotors_apart(robot, request), testing::Contains(2));
  EXPECT_THAT(
      desk::base_parameters(robot, request).names,
      testing::Contains(testing::AllOf(testing::HasSubstr("Izz1"), testing::HasSubstr(" + Ia1"))));
}

TEST(DriveModel, LeavesWhatTheFileSaysOfMotors) {
  RobotDescription robot = plain_arm(2);
  robot.effects.clear();
  robot.transmission.emplace();
  robot.transmission->matrix = {{10, 10}, {0, 10}};
  desk::RobotEffect friction;
  friction.kind = EffectKind::kViscousFriction;
  friction.fitted = true;
  friction.of_motor = true;
  robot.effects = {friction};
  const desk::DriveModel drives = drive_model(robot, {{1, 1}, {0, 1}, false});
  EXPECT_THAT(drives.refitted, testing::IsEmpty());
  for (const auto& one : drives.added) {
    EXPECT_NE(one.kind, EffectKind::kViscousFriction) << "motor 1 moves both joints";
  }
}

TEST(DriveModel, HasNoRotorWhereASensorBehindTheGearIsRead) {
  RobotDescription robot = plain_arm(2);
  robot.effects.clear();
  const desk::DriveModel drives = drive_model(robot, {{1, 1}, {0, 1}, false, {1, 0}});
  std::vector<std::size_t> rotors;
  for (const auto& one : drives.added) {
    if (one.kind == EffectKind::kRotorInertia) rotors.push_back(one.joint);
  }
  EXPECT_THAT(rotors, testing::ElementsAre(1U));
}

TEST(BaseParameters, OfAnArmWhoseFirstJointStandsLackWhatItAloneShows) {
  const RobotDescription robot = plain_arm(2);
  BaseRequest request = whole(robot);
  const auto all = base_parameters(robot, request).count();
  request.moves[0] = 0;
  EXPECT_LT(base_parameters(robot, request).count(), all);
}

}  // namespace
}  // namespace offnominal::test
