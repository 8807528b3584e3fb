#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <memory>

#include "desk/support/temporary_folder.hpp"
#include "exchange/export_robot.hpp"
#include "exchange/import_urdf.hpp"
#include "rigid_torque.hpp"
#include "robot/robot_file.hpp"
#include "support/repetitions.hpp"
#include "support/robots.hpp"
#include "support/seed.hpp"
#include "urdfs.hpp"

// What is written as MJCF, as MuJoCo understands it.

namespace offnominal::test {
namespace {

using desk::RobotDescription;
using desk::RobotEffect;
using desk::exchange::export_mjcf;

using Model = std::unique_ptr<mjModel, decltype(&mj_deleteModel)>;
using Data = std::unique_ptr<mjData, decltype(&mj_deleteData)>;

Model load(const std::string& mjcf) {
  const TemporaryFolder folder;
  put(folder / "robot.xml", mjcf);
  char error[1000] = "";
  Model model(mj_loadXML((folder / "robot.xml").c_str(), nullptr, error, sizeof error),
              mj_deleteModel);
  EXPECT_NE(model, nullptr) << error;
  return model;
}

void add(RobotDescription& robot, EffectKind kind, int joint,
         std::array<double, kMaxEffectParameters> parameters) {
  RobotEffect effect;
  effect.kind = kind;
  effect.joint = static_cast<std::uint8_t>(joint);
  effect.parameters = parameters;
  robot.effects.push_back(effect);
}

// Effects that MJCF has a place for, dry friction aside, which MuJoCo solves for as a constraint.
bool is_carried(const RobotEffect& effect) {
  switch (effect.kind) {
    case EffectKind::kViscousFriction:
    case EffectKind::kRotorInertia:
    case EffectKind::kJointStiffness:
    case EffectKind::kTipPayload:
    case EffectKind::kLinkMass:
      return true;
    default:
      return false;
  }
}

void expect_same_torques(const RobotDescription& robot) {
  const Model model = load(export_mjcf(robot, "robot.toml").text);
  ASSERT_NE(model, nullptr);
  ASSERT_EQ(model->nv, robot.joint_count());
  model->opt.disableflags |= mjDSBL_FRICTIONLOSS | mjDSBL_LIMIT;
  const Data data(mj_makeData(model.get()), mj_deleteData);
  const auto comparable = without(robot, [](const auto& effect) { return !is_carried(effect); });
  std::mt19937_64 generator = seeded_generator();
  double worst = 0;
  for (int i = 0; i < repetitions(1000); ++i) {
    const MotionState state = random_state(generator, robot.joint_count());
    std::copy(state.q.begin(), state.q.end(), data->qpos);
    std::copy(state.dq.begin(), state.dq.end(), data->qvel);
    std::copy(state.ddq.begin(), state.ddq.end(), data->qacc);
    mj_inverse(model.get(), data.get());
    const std::vector<double> theirs(data->qfrc_inverse, data->qfrc_inverse + model->nv);
    worst = std::max(worst, deviation(torque_of(comparable, state), theirs));
  }
  EXPECT_LE(worst, 1e-6);
  std::cout << "largest deviation: " << worst << '\n';
}

class MjcfOfUrdf : public testing::TestWithParam<UrdfCase> {};

TEST_P(MjcfOfUrdf, GivesTheSameTorquesInMujoco) {
  const UrdfCase& of = GetParam();
  OFFNOMINAL_SKIP_WITHOUT(of);
  RobotDescription robot =
      desk::exchange::import_urdf(of.text(), of.file.string(), of.chain()).robot;
  expect_same_torques(robot);
  // As a session of add would leave it.
  for (int i = 0; i < robot.joint_count(); ++i) {
    add(robot, EffectKind::kViscousFriction, i, {0.3 + i});
    add(robot, EffectKind::kRotorInertia, i, {0.05 + 0.01 * i});
    add(robot, EffectKind::kCoulombFriction, i, {1.5, 0.01});
  }
  add(robot, EffectKind::kJointStiffness, 0, {12, 0.4});
  add(robot, EffectKind::kJointStiffness, 0, {3, -0.2});
  add(robot, EffectKind::kTipPayload, robot.joint_count() - 1, {0.8, 0.05, -0.02, 0.1});
  add(robot, EffectKind::kLinkMass, 0, {-0.1});
  expect_same_torques(robot);
}

INSTANTIATE_TEST_SUITE_P(All, MjcfOfUrdf, testing::ValuesIn(all_urdfs()),
                         [](const auto& one) { return one.param.name; });

TEST(Mjcf, OfEveryRobotOfTheProjectGivesTheSameTorquesInMujoco) {
  int robots = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kRobots)) {
    if (entry.path().extension() != ".toml") continue;
    SCOPED_TRACE(entry.path());
    expect_same_torques(desk::read_robot_file(entry.path()));
    ++robots;
  }
  EXPECT_GE(robots, 4);
}

TEST(Mjcf, CarriesFrictionLossDampingArmatureAndLimits) {
  RobotDescription robot =
      desk::exchange::import_urdf(sample_arm().text(), "arm.urdf", sample_arm().chain()).robot;
  add(robot, EffectKind::kRotorInertia, 2, {0.21});
  add(robot, EffectKind::kCoulombFriction, 2, {0.4, 0.02});
  const auto exported = export_mjcf(robot, "arm.toml");
  const Model model = load(exported.text);
  ASSERT_NE(model, nullptr);
  EXPECT_DOUBLE_EQ(model->dof_damping[0], 0.7);
  EXPECT_DOUBLE_EQ(model->dof_frictionloss[0], 1.25);
  EXPECT_DOUBLE_EQ(model->dof_frictionloss[1], 9);
  EXPECT_DOUBLE_EQ(model->dof_frictionloss[2], 0.4);
  EXPECT_DOUBLE_EQ(model->dof_armature[2], 0.21);
  EXPECT_DOUBLE_EQ(model->jnt_range[0], -1.9);
  EXPECT_DOUBLE_EQ(model->jnt_range[1], 2.1);
  EXPECT_FALSE(model->jnt_limited[2]);
  EXPECT_DOUBLE_EQ(model->actuator_ctrlrange[1], 60);
  EXPECT_STREQ(mj_id2name(model.get(), mjOBJ_JOINT, 1), "slide");
}

void add_of_motor(RobotDescription& robot, EffectKind kind, int motor,
                  std::array<double, kMaxEffectParameters> parameters) {
  add(robot, kind, motor, parameters);
  robot.effects.back().of_motor = true;
}

// By hand: an inertia or damping of the motor is ratio^2 times as large at the joint, its dry
// friction |ratio| times.
// MuJoCo has a body of that name already.
TEST(Mjcf, OfAJointThatIsCalledWorldIsLoaded) {
  RobotDescription robot = desk::read_robot_file(kRobots / "two_link.toml");
  robot.joints[0].name = "world";
  expect_same_torques(robot);
}

TEST(Mjcf, CarriesWhatIsAtAMotorThatMovesOneJointAlone) {
  RobotDescription robot =
      desk::exchange::import_urdf(sample_arm().text(), "arm.urdf", sample_arm().chain()).robot;
  robot.effects.clear();
  robot.transmission.emplace();
  robot.transmission->ratio = {-50, 200, 1};
  for (int motor = 0; motor < 2; ++motor) {
    add_of_motor(robot, EffectKind::kRotorInertia, motor, {1e-4});
    add_of_motor(robot, EffectKind::kViscousFriction, motor, {2e-4});
    add_of_motor(robot, EffectKind::kCoulombFriction, motor, {0.01, 0.5});
  }
  add(robot, EffectKind::kRotorInertia, 0, {0.5});
  add_of_motor(robot, EffectKind::kStribeckFriction, 2, {0.5, 0.1, 0.01});
  const auto exported = export_mjcf(robot, "arm.toml");
  const Model model = load(exported.text);
  ASSERT_NE(model, nullptr);
  EXPECT_NEAR(model->dof_armature[0], 0.25 + 0.5, 1e-12);
  EXPECT_NEAR(model->dof_armature[1], 4, 1e-12);
  EXPECT_NEAR(model->dof_damping[0], 0.5, 1e-12);
  EXPECT_NEAR(model->dof_damping[1], 8, 1e-12);
  EXPECT_NEAR(model->dof_frictionloss[0], 0.5, 1e-12);
  EXPECT_NEAR(model->dof_frictionloss[1], 2, 1e-12);
  using testing::Contains;
  using testing::HasSubstr;
  EXPECT_THAT(exported.changed, Contains(HasSubstr("rotor_inertia of motor 1")));
  EXPECT_THAT(exported.not_carried, Contains(HasSubstr("stribeck_friction of motor 3")));
}

TEST(Mjcf, NamesWhatIsAtMotorsThatJointsShare) {
  RobotDescription robot =
      desk::exchange::import_urdf(sample_arm().text(), "arm.urdf", sample_arm().chain()).robot;
  robot.transmission.emplace();
  robot.transmission->matrix = {{0, 30, 0}, {20, 0, 0}, {0, 0, 10}};
  add_of_motor(robot, EffectKind::kRotorInertia, 0, {1e-4});
  // Motor 1 moves joint 2, alone.
  const Model model = load(export_mjcf(robot, "arm.toml").text);
  ASSERT_NE(model, nullptr);
  EXPECT_NEAR(model->dof_armature[1], 0.09, 1e-12);
  robot.transmission->matrix = {{40, 20, 0}, {40, -20, 0}, {0, 0, 10}};
  const auto shared = export_mjcf(robot, "arm.toml");
  EXPECT_THAT(shared.not_carried,
              testing::Contains(testing::HasSubstr("joints share the motors it moves with")));
  EXPECT_EQ(load(shared.text)->dof_armature[1], 0);
}

TEST(UrdfInMujoco, OfEveryRobotOfTheProjectIsLoaded) {
  int point_masses = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kRobots)) {
    if (entry.path().extension() != ".toml") continue;
    SCOPED_TRACE(entry.path());
    const RobotDescription robot = desk::read_robot_file(entry.path());
    const auto exported = desk::exchange::export_urdf(robot, "robot.toml");
    const Model model = load(exported.text);
    ASSERT_NE(model, nullptr);
    EXPECT_EQ(model->nv, robot.joint_count());
    point_masses += std::any_of(exported.changed.begin(), exported.changed.end(),
                                [](const std::string& line) {
                                  return line.find("a point mass or a rod") != std::string::npos;
                                })
                        ? 1
                        : 0;
  }
  EXPECT_GE(point_masses, 3);
}

TEST(Mjcf, SlowsDownByItsFrictionAsTheModelSays) {
  // A slide without gravity: the friction alone stops it, after v/(friction/mass) seconds.
  RobotDescription robot;
  robot.name = "sledge";
  robot.gravity_m_s2 = {0, 0, 0};
  robot.joints.resize(1);
  robot.joints[0].name = "rail";
  robot.joints[0].joint.type = JointType::kPrismatic;
  robot.joints[0].joint.mass_kg = 2;
  add(robot, EffectKind::kCoulombFriction, 0, {3, 0.01});
  add(robot, EffectKind::kRotorInertia, 0, {1});
  const Model model = load(export_mjcf(robot, "sledge.toml").text);
  ASSERT_NE(model, nullptr);
  const Data data(mj_makeData(model.get()), mj_deleteData);
  data->qvel[0] = 1;
  while (data->time < 0.5) mj_step(model.get(), data.get());
  EXPECT_NEAR(data->qvel[0], 0.5, 0.01);
  while (data->time < 1.2) mj_step(model.get(), data.get());
  EXPECT_NEAR(data->qvel[0], 0, 0.01);
}

TEST(Mjcf, NamesWhatItDoesNotCarryInTheResultAndInTheFile) {
  RobotDescription robot =
      desk::exchange::import_urdf(sample_arm().text(), "arm.urdf", sample_arm().chain()).robot;
  robot.joints[0].name = "a \"b\" <c> -- & d";
  robot.joints[1].encoder.counts_per_unit = 1000;
  robot.joints[2].kp = 5;
  add(robot, EffectKind::kStribeckFriction, 0, {0.5, 0.1, 0.01});
  add(robot, EffectKind::kViscousFriction, 1, {-7});
  add(robot, EffectKind::kLinkMass, 2, {-0.66});
  const auto exported = export_mjcf(robot, "arm.toml");
  using testing::Contains;
  using testing::HasSubstr;
  EXPECT_THAT(exported.not_carried, Contains(HasSubstr("stribeck_friction of joint `a \"b\"")));
  EXPECT_THAT(exported.not_carried, Contains("damping below zero (-7) of joint `slide`"));
  EXPECT_THAT(exported.not_carried, Contains(HasSubstr("link_mass of joint `wrist`")));
  EXPECT_THAT(exported.not_carried, Contains("the encoder of joint `slide`"));
  EXPECT_THAT(exported.not_carried, Contains("the gains of joint `wrist`"));
  EXPECT_THAT(exported.not_carried, Contains("the limit of velocity of joint `slide`"));
  EXPECT_THAT(exported.text, HasSubstr("not carried: the encoder of joint `slide`"));
  const Model model = load(exported.text);
  ASSERT_NE(model, nullptr);
  EXPECT_STREQ(mj_id2name(model.get(), mjOBJ_JOINT, 0), "a \"b\" <c> -- & d");
}

}  // namespace
}  // namespace offnominal::test
