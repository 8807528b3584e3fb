// A robot file's controller at one end of a bus, the same robot in MuJoCo at the other.
#include "sil/mujoco_plant_of.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "desk/sil/run_of_robot.hpp"
#include "desk/sil/serial_robot.hpp"
#include "desk/support/temporary_folder.hpp"
#include "exchange/export_robot.hpp"

namespace offnominal::desk::sil {
namespace {

using sim::FaultEvent;
using sim::FaultEventKind;
using test::serial_robot;
using test::TemporaryFolder;
using testing::HasSubstr;

// A scenario whose plant is `plant` as an MJCF, for the joints of `robot`.
Scenario in_mujoco(const RobotDescription& robot, const RobotDescription& plant,
                   const TemporaryFolder& folder, std::vector<sim::FaultEvent> faults = {}) {
  test::put(folder / "plant.xml", exchange::export_mjcf(plant, "").text);
  Scenario scenario = scenario_of(robot, std::move(faults));
  scenario.mujoco = (folder / "plant.xml").string();
  return scenario;
}

// MuJoCo's dry friction holds a joint at rest, which the model's does not know: left out, or
// bounded.
RobotDescription without_dry_friction(int joints) {
  RobotDescription robot = serial_robot(joints);
  std::erase_if(robot.effects,
                [](const auto& one) { return one.kind == EffectKind::kCoulombFriction; });
  return robot;
}

class InMujoco : public testing::TestWithParam<int> {};

TEST_P(InMujoco, ARobotFollowsItsMotionAndIsQuietWhileItIsHealthy) {
  const TemporaryFolder folder;
  const RobotDescription robot = without_dry_friction(GetParam());
  const SilResult result = run(robot, in_mujoco(robot, robot, folder));
  EXPECT_EQ(result.state, hal::ControllerState::kArmed) << controller::name_of(result.fault);
  EXPECT_FALSE(result.run.detection_time_s.has_value());
  EXPECT_LT(result.run.tracking_rms_rad, 0.01);
}

TEST_P(InMujoco, ARobotShowsAFaultWhenItBegins) {
  const TemporaryFolder folder;
  const RobotDescription robot = without_dry_friction(GetParam());
  for (const FaultEvent& fault :
       {FaultEvent{.kind = FaultEventKind::kPayload, .begin_s = 1, .size = 2},
        FaultEvent{.kind = FaultEventKind::kMassLoss, .begin_s = 1, .joint = 0, .size = 0.9},
        FaultEvent{.kind = FaultEventKind::kFrictionJump, .begin_s = 1, .joint = 0, .size = 8}}) {
    const SilResult result = run(robot, in_mujoco(robot, robot, folder, {fault}));
    ASSERT_TRUE(result.run.detection_time_s.has_value()) << info_of(fault.kind).name;
    EXPECT_GE(*result.run.detection_time_s, 1.0) << info_of(fault.kind).name;
    EXPECT_LT(*result.run.detection_time_s, 1.7) << info_of(fault.kind).name;
  }
}

TEST_P(InMujoco, DryFrictionHoldsARobotAtRestAsItsBoundHasToKnow) {
  const TemporaryFolder folder;
  RobotDescription robot = serial_robot(GetParam());
  EXPECT_TRUE(run(robot, in_mujoco(robot, robot, folder)).run.detection_time_s.has_value());
  robot.bound->constant.value = 20;
  EXPECT_FALSE(run(robot, in_mujoco(robot, robot, folder)).run.detection_time_s.has_value());
}

INSTANTIATE_TEST_SUITE_P(Joints, InMujoco, testing::Values(1, 6));

TEST(MujocoPlantOf, RefusesWhatIsNotTheRobot) {
  const TemporaryFolder folder;
  const RobotDescription robot = serial_robot(2);
  EXPECT_THAT(refusal(robot, in_mujoco(robot, serial_robot(3), folder)),
              HasSubstr("plant.xml: joints: found 3 of them; allowed: 2, as robot serial has"));

  RobotDescription slides = robot;
  slides.joints[1].joint.type = JointType::kPrismatic;
  EXPECT_THAT(refusal(robot, in_mujoco(robot, slides, folder)),
              HasSubstr("joint 2, joint2: found one that slides; allowed: one that turns"));

  RobotDescription swapped = robot;
  std::swap(swapped.joints[0].name, swapped.joints[1].name);
  EXPECT_THAT(refusal(robot, in_mujoco(robot, swapped, folder)),
              HasSubstr("joint 1: found joint2; allowed: joint1"));

  Scenario hidden = in_mujoco(robot, robot, folder);
  hidden.hidden.emplace_back();
  EXPECT_THAT(refusal(robot, hidden), HasSubstr("an effect hidden in a plant of MuJoCo"));

  Scenario broken = in_mujoco(robot, robot, folder);
  test::put(folder / "plant.xml", "<mujoco><worldbody>");
  EXPECT_THAT(refusal(robot, broken), HasSubstr("plant.xml: found XML parse error"));
  broken.mujoco = (folder / "none.xml").string();
  EXPECT_THAT(refusal(robot, broken), HasSubstr("none.xml: found "));
}

TEST(MujocoPlantOf, IsNamedByItsPrefix) {
  EXPECT_EQ(mujoco_file_named("mujoco:a/b.xml"), "a/b.xml");
  EXPECT_EQ(mujoco_file_named("robot.toml"), std::nullopt);
}

}  // namespace
}  // namespace offnominal::desk::sil
