#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "inertial/identify.hpp"
#include "inertial/pseudo_inertia.hpp"
#include "mujoco_plant.hpp"

// What the last link carries, told against a file that is trusted.

namespace offnominal::test {
namespace {

using desk::Identification;
using desk::IdentifyRequest;
using desk::Log;
using desk::RobotDescription;

// A point mass on the last link.
RobotDescription carrying(RobotDescription robot, double mass_kg, const Eigen::Vector3d& at) {
  desk::InertialNumbers added;
  added << mass_kg, mass_kg * at, mass_kg * (at.squaredNorm() - at.x() * at.x()),
      mass_kg * (at.squaredNorm() - at.y() * at.y()),
      mass_kg * (at.squaredNorm() - at.z() * at.z()), -mass_kg * at.x() * at.y(),
      -mass_kg * at.x() * at.z(), -mass_kg * at.y() * at.z();
  Joint<double>& last = robot.joints.back().joint;
  desk::put_inertia(desk::inertial_numbers_of(last) + added, last);
  return robot;
}

// The file knows the drives.
RobotDescription trusted_file(std::size_t joints) {
  RobotDescription robot = plain_arm(joints);
  const auto drives = plain_drives(joints);
  for (std::size_t i = 0; i < joints; ++i) {
    const auto add = [&](EffectKind kind, double value, double width = 0) {
      desk::RobotEffect effect;
      effect.kind = kind;
      effect.joint = static_cast<std::uint8_t>(i);
      effect.parameters = {value, width};
      robot.effects.push_back(effect);
    };
    add(EffectKind::kViscousFriction, drives[i].viscous);
    add(EffectKind::kCoulombFriction, drives[i].coulomb, 0.005);
    add(EffectKind::kRotorInertia, drives[i].rotor);
    add(EffectKind::kTorqueOffset, drives[i].offset);
  }
  return robot;
}

Identification payload_of(const RobotDescription& file, const Log& log) {
  IdentifyRequest request;
  request.payload = true;
  request.source = "a test";
  const std::vector<Log> logs{log};
  return identify(file, request, logs, {});
}

TEST(Payload, OfSixJointsIsAMassWithAPlace) {
  const RobotDescription file = trusted_file(6);
  const Eigen::Vector3d place(0.05, -0.02, 0.1);
  MujocoPlant plant(carrying(file, 0.8, place), plain_drives(6));
  PlantMotion motion;
  motion.duration_s = 12;
  const Identification result = payload_of(file, plant.record(motion));
  ASSERT_TRUE(result.payload.has_value());
  EXPECT_TRUE(result.objections.empty());
  EXPECT_TRUE(result.payload->mass.determined);
  EXPECT_NEAR(result.payload->mass.after, 0.8, 0.04);
  ASSERT_TRUE(result.payload->mass.ci95.has_value());
  EXPECT_LT((*result.payload->mass.ci95)[0], 0.8);
  EXPECT_GT((*result.payload->mass.ci95)[1], 0.8);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(result.payload->place[axis].after, place[static_cast<Eigen::Index>(axis)], 0.02);
  }
  // Nothing but the last link is another one.
  for (std::size_t i = 0; i + 1 < file.joints.size(); ++i) {
    EXPECT_EQ(result.robot.joints[i].joint.mass_kg, file.joints[i].joint.mass_kg);
  }
  EXPECT_EQ(result.robot.effects.size(), file.effects.size());
}

TEST(Payload, ThatIsGoneIsLessThanNothing) {
  const RobotDescription bare = trusted_file(4);
  const RobotDescription loaded = carrying(bare, 0.5, {0.1, 0, 0.05});
  MujocoPlant plant(bare, plain_drives(4));
  PlantMotion motion;
  motion.duration_s = 12;
  const Identification result = payload_of(loaded, plant.record(motion));
  EXPECT_NEAR(result.payload->mass.after, -0.5, 0.05);
}

TEST(Payload, ThatIsNotThereIsNearNothing) {
  const RobotDescription file = trusted_file(4);
  MujocoPlant plant(file, plain_drives(4));
  PlantMotion motion;
  motion.duration_s = 12;
  const Identification result = payload_of(file, plant.record(motion));
  EXPECT_NEAR(result.payload->mass.after, 0, 0.03);
}

TEST(Payload, OfAPendulumCannotBeToldFromItsPlace) {
  RobotDescription file = trusted_file(1);
  file.joints[0].joint.axis = {0, 1, 0};
  MujocoPlant plant(carrying(file, 0.8, {0.2, 0, 0.1}), plain_drives(1));
  const Identification result = payload_of(file, plant.record({}));
  EXPECT_FALSE(result.payload->mass.determined);
  EXPECT_THAT(result.notes,
              testing::Contains(testing::AllOf(testing::HasSubstr("do not tell its mass"),
                                               testing::HasSubstr("hx1 (+0.16"))));
}

}  // namespace
}  // namespace offnominal::test
