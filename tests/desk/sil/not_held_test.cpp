// Runs that end in a safe state which nobody asked for, and what is said of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "desk/sil/run_of_robot.hpp"
#include "desk/sil/serial_robot.hpp"
#include "robot/robot_file.hpp"
#include "sil/sil_report.hpp"

namespace offnominal::desk::sil {
namespace {

using sim::FaultEventKind;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kNothingWrong = "Nothing is wrong";

constexpr int kJoints = 3;

// With that limit of every joint.
RobotDescription with_torque(const std::string& limit) {
  const std::string was = "torque = 150.0";
  std::string text = test::serial_robot_text(kJoints);
  for (std::size_t at = text.find(was); at != std::string::npos; at = text.find(was, at + 1)) {
    text.replace(at, was.size(), "torque = " + limit);
  }
  return parse_robot(text, "robot.toml");
}

SilResult not_held_run(const RobotDescription& robot, const Scenario& scenario) {
  SilResult result = run(robot, scenario);
  EXPECT_EQ(result.fault, controller::Fault::kArmNotHeld);
  EXPECT_TRUE(is_unasked_stop(result));
  EXPECT_TRUE(result.not_held.has_value());
  if (!result.not_held) result.not_held.emplace();
  return result;
}

TEST(ArmThatIsNotHeld, FallsWhereItsTorqueComesInTooSlowly) {
  const RobotDescription robot =
      parse_robot(test::serial_robot_text(kJoints) + "[arming]\ntorque_rate = [90.0, 90.0, 90.0]\n",
                  "robot.toml");
  const SilResult result = not_held_run(robot, scenario_of(robot));
  EXPECT_THAT(result.not_held->causes,
              ElementsAre(AllOf(HasSubstr("falls until its weight"),
                                HasSubstr("joint 1 (joint1) has"), HasSubstr("torque_rate"))));
  EXPECT_GT(result.not_held->moved, result.not_held->window);
  EXPECT_THAT(sentence_of(result),
              AllOf(HasSubstr("The arm was not held: joint "), HasSubstr("position_window"),
                    HasSubstr("ArmNotHeld"), Not(HasSubstr(kNothingWrong))));
  const auto json = to_json(result);
  EXPECT_EQ(json.at("unasked_stop"), true);
  EXPECT_EQ(json.at("not_held").at("joint"), result.not_held->joint + 1);
  EXPECT_TRUE(json.at("time_to_safe_state_s").is_null());
  EXPECT_EQ(json.at("verdict"), sentence_of(result));
}

TEST(ArmThatIsNotHeld, WeighsMoreThanItsDriveMayGive) {
  const RobotDescription robot = with_torque("4.0");
  const SilResult result = not_held_run(robot, scenario_of(robot));
  EXPECT_THAT(result.not_held->causes.at(0),
              AllOf(HasSubstr("joint 1 (joint1) has"), HasSubstr("is 4.00 N m: raise that")));
}

TEST(ArmThatIsNotHeld, IsAnotherThanTheControllersFileSays) {
  const RobotDescription robot = with_torque("150.0");
  Scenario scenario = scenario_of(robot);
  for (RobotJoint& joint : scenario.plant->joints) joint.joint.mass_kg *= 12;
  const SilResult result = not_held_run(robot, scenario);
  EXPECT_THAT(result.not_held->causes.at(0), HasSubstr("the plant is another arm"));
}

// A controller that pushes by friction which the plant has not, a period late.
TEST(ArmThatIsNotHeld, IsShakenByFrictionThatIsTooSharpForThePeriod) {
  RobotDescription robot = test::serial_robot(kJoints);
  Scenario scenario = scenario_of(robot);
  std::erase_if(scenario.plant->effects, [](const RobotEffect& effect) {
    return effect.kind == EffectKind::kCoulombFriction;
  });
  for (RobotEffect& effect : robot.effects) {
    if (effect.kind == EffectKind::kCoulombFriction) effect.parameters = {8.0, 1e-3};
  }
  const SilResult result = not_held_run(robot, scenario);
  EXPECT_THAT(result.not_held->causes, testing::Contains(AllOf(HasSubstr("adds friction to joint"),
                                                               HasSubstr("smoothing"))));
}

// GIVEN a fault that has begun, or a detection that the controller is told to stop at, THEN the
// safe state is what was asked for; GIVEN one that is still to come, it is not.
TEST(SafeState, IsAskedForByAFaultThatHasBegun) {
  const RobotDescription robot = test::serial_robot(kJoints);
  const auto silent_at = [](double begin_s) {
    return std::vector<sim::FaultEvent>{
        {.kind = FaultEventKind::kSilentNode, .begin_s = begin_s, .joint = 1}};
  };
  const SilResult asked = run(robot, scenario_of(robot, silent_at(1.0)));
  EXPECT_EQ(asked.state, hal::ControllerState::kFault);
  EXPECT_FALSE(is_unasked_stop(asked));
  EXPECT_TRUE(asked.time_to_safe_state_s.has_value());
  const RobotDescription weak = with_torque("4.0");
  EXPECT_TRUE(is_unasked_stop(run(weak, scenario_of(weak, silent_at(1.0)))));
}

TEST(SafeState, IsAskedForByADetectionThatItIsToldToStopAt) {
  const RobotDescription robot = test::serial_robot(kJoints);
  Scenario scenario =
      scenario_of(robot, {{.kind = FaultEventKind::kPayload, .begin_s = 1.0, .size = 3.0}});
  scenario.at_detection = controller::AtDetection::kStop;
  const SilResult result = run(robot, scenario);
  EXPECT_EQ(result.fault, controller::Fault::kDetected);
  EXPECT_FALSE(is_unasked_stop(result));
  ASSERT_TRUE(result.run.detection_time_s) << "what it stopped for is told";
  EXPECT_GT(*result.run.detection_time_s, 1.0);
}

}  // namespace
}  // namespace offnominal::desk::sil
