#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "common/error.hpp"
#include "robot/robot_file.hpp"
#include "sample_robot.hpp"

// Robot files in EstimatorSpace::kTorque, and bounds joint by joint.

namespace offnominal::desk {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

std::string space_refusal(const std::string& text) {
  try {
    static_cast<void>(parse_robot(text, "dir/r.toml"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

// The sample in torque space, with `bound` in place of its bound.
std::string in_torque_space(const std::string& bound) {
  std::string text = test::changed(test::kSampleRobot, "seed = 7", "seed = 7\nspace = \"torque\"");
  const auto begin = text.find("[uncertainty_bound]");
  const auto end = text.find("\n[", begin);
  return text.substr(0, begin) + bound + text.substr(std::min(end, text.size()));
}

TEST(RobotFile, RefusesABoundThatDoesNotGoWithTheSpace) {
  EXPECT_THAT(
      space_refusal(test::changed(test::kSampleRobot, "seed = 7", "seed = 7\nspace = \"torque\"")),
      AllOf(HasSubstr("uncertainty_bound.kind: found a bound of accelerations beside "
                      "estimator.space = \"torque\""),
            HasSubstr("allowed: \"per_joint\", N m or N per joint"),
            HasSubstr("to mend: leave [uncertainty_bound] out")));
  const std::string per_joint = "[uncertainty_bound]\nkind = \"per_joint\"\nvalue = [1.0, 2.0]\n";
  EXPECT_EQ(space_refusal(in_torque_space(per_joint)), "accepted");
  EXPECT_EQ(space_refusal(in_torque_space("")), "accepted") << "calibrate finds one";
  EXPECT_THAT(space_refusal(test::changed(in_torque_space(per_joint), "space = \"torque\"",
                                          "space = \"acceleration\"")),
              HasSubstr("a bound of torques, beside estimator.space = \"acceleration\""));
}

TEST(RobotFile, RefusesBoundsPerJointThatAreNotOnePerJoint) {
  const auto with = [](const std::string& keys) {
    return space_refusal(
        in_torque_space("[uncertainty_bound]\nkind = \"per_joint\"\n" + keys + "\n"));
  };
  EXPECT_THAT(with("value = [1.0]"), HasSubstr("uncertainty_bound.value: found a list of 1"));
  EXPECT_THAT(with("value = [1.0, 0.0]"),
              HasSubstr("found 0 for joint 2; allowed: a number above 0"));
  EXPECT_THAT(with("value = [1.0, -2.0]"), HasSubstr("uncertainty_bound.value[2]: found -2"));
  EXPECT_THAT(with("value = [1.0, 2.0]\nvelocity_error = 0.1"),
              HasSubstr("a key that a bound of kind per_joint does not have"));
  EXPECT_THAT(with("value = [1.0, 2.0]\nmomentum_error = [0.1, -0.1]"),
              HasSubstr("uncertainty_bound.momentum_error[2]: found -0.1"));
  const std::string table = "over_speed = [{joint = 2, at = [0.0, 1.0], value = [1.0, 2.0]}";
  EXPECT_EQ(with("value = [1.0, 0.0]\n" + table + "]"), "accepted");
  EXPECT_THAT(with("value = [1.0, 2.0]\n" + table + "]"),
              HasSubstr("found 2 for joint 2; allowed: 0, as a table has this joint's values"));
  EXPECT_THAT(
      with("value = [1.0, 0.0]\n" + table + ", {joint = 2, at = [0.0, 1.0], value = [1.0, 2.0]}]"),
      HasSubstr("joint 2 a second time"));
  EXPECT_THAT(
      with("value = [1.0, 0.0]\nover_speed = [{joint = 2, at = [1.0, 0.0], value = [1.0, 2.0]}]"),
      HasSubstr("0 after 1; allowed: strictly rising numbers"));
  EXPECT_THAT(
      with("value = [1.0, 0.0]\nover_speed = [{joint = 3, at = [0.0, 1.0], value = [1.0, 2.0]}]"),
      HasSubstr("a whole number from 1 to 2"));
}

TEST(RobotFile, HasTablesOverOneVariableOfEachJoint) {
  const RobotDescription robot = parse_robot(
      in_torque_space("[uncertainty_bound]\nkind = \"per_joint\"\nvalue = [0.0, 0.0]\n"
                      "over_position = [{joint = 1, at = [-1.0, 1.0], value = [1.0, 2.0]}]\n"
                      "over_torque = [{joint = 2, at = [0.0, 5.0], value = [1.0, 2.0]}]\n"
                      "act_ratio = [1.0, 1.5]\n"),
      "arm.toml");
  EXPECT_EQ(robot.bound->joints[0].variable, BoundVariable::kPosition);
  EXPECT_EQ(robot.bound->joints[0].at, (std::vector{-1.0, 1.0}));
  EXPECT_EQ(robot.bound->joints[1].variable, BoundVariable::kTorque);
  EXPECT_EQ(robot.bound->joints[1].act_ratio, 1.5);
  const auto with = [](const std::string& keys) {
    return space_refusal(
        in_torque_space("[uncertainty_bound]\nkind = \"per_joint\"\n" + keys + "\n"));
  };
  const std::string of_second = "{joint = 2, at = [0.0, 1.0], value = [1.0, 2.0]}";
  EXPECT_THAT(with("value = [1.0, 0.0]\nover_speed = [" + of_second + "]\nover_torque = [" +
                   of_second + "]"),
              HasSubstr("joint 2 a second time"));
  EXPECT_THAT(with("value = [1.0, 0.0]\nover_torque = [{joint = 2, at = [-1.0, 1.0], value = "
                   "[1.0, 2.0]}]"),
              HasSubstr("found -1"));
  EXPECT_THAT(with("value = [1.0, 2.0]\nact_ratio = [1.0, 0.9]"),
              HasSubstr("uncertainty_bound.act_ratio[2]: found 0.9"));
}

TEST(RobotFile, HasBoundsOfASecondFilterWhereItHasTheFilterAndOnlyThere) {
  const std::string bound = "[uncertainty_bound]\nkind = \"per_joint\"\nvalue = [1.0, 2.0]\n";
  const std::string fast = "fast = {value = [3.0, 4.0], act_ratio = [1.0, 2.0]}\n";
  const auto with_filter = [](const std::string& text, const std::string& pole) {
    return test::changed(text, "seed = 7", "seed = 7\nfast_alpha_per_s = " + pole);
  };
  const RobotDescription robot =
      parse_robot(with_filter(in_torque_space(bound + fast), "70.0"), "arm.toml");
  EXPECT_EQ(robot.estimator.fast_alpha, 70);
  ASSERT_EQ(robot.bound->fast.size(), 2U);
  EXPECT_EQ(robot.bound->fast[1].value, std::vector{4.0});
  EXPECT_EQ(robot.bound->fast[1].act_ratio, 2);
  EXPECT_EQ(space_refusal(with_filter(in_torque_space(""), "70.0")), "accepted")
      << "calibrate finds both";
  EXPECT_THAT(space_refusal(with_filter(in_torque_space(bound), "70.0")),
              AllOf(HasSubstr("no bounds of the second filter"), HasSubstr("calibrate")));
  EXPECT_THAT(space_refusal(in_torque_space(bound + fast)),
              HasSubstr("bounds of a second filter that the estimator does not have"));
  EXPECT_THAT(space_refusal(with_filter(in_torque_space(""), "1.0")),
              HasSubstr("above alpha_per_s"));
  EXPECT_THAT(space_refusal(with_filter(in_torque_space(""), "1e5")),
              HasSubstr("fast_alpha_per_s * period_s"));
  EXPECT_THAT(space_refusal(with_filter(test::kSampleRobot, "70.0")),
              HasSubstr("beside a monitor that judges all joints by one norm"));
  EXPECT_THAT(space_refusal(with_filter(
                  in_torque_space(bound + "fast = {value = [3.0, 4.0], momentum_error = [0.0]}\n"),
                  "70.0")),
              HasSubstr("momentum_error"))
      << "it is that of the joints' own bounds";
}

TEST(RobotFile, NamesTheKindsOfItsSpaceWhereABoundHasNone) {
  EXPECT_THAT(space_refusal(in_torque_space("[uncertainty_bound]\nvalue = [1.0, 2.0]\n")),
              AllOf(ContainsRegex("line [0-9]+, uncertainty_bound.kind: found nothing"),
                    HasSubstr("allowed: per_joint;")));
  EXPECT_THAT(space_refusal(in_torque_space("[uncertainty_bound]\nkind = \"per_jiont\"\n")),
              AllOf(HasSubstr("allowed: per_joint;"), HasSubstr("write \"per_joint\"")));
  const std::string sample = test::kSampleRobot;
  const auto kind = sample.find("kind = ", sample.find("[uncertainty_bound]"));
  const std::string without = sample.substr(0, kind) + sample.substr(sample.find('\n', kind) + 1);
  EXPECT_THAT(space_refusal(without), AllOf(HasSubstr("allowed: constant, scaled_norm, table;"),
                                            Not(HasSubstr("per_joint"))));
}

// With such a number every sample overflows, and the recording would be blamed.
TEST(RobotFile, RefusesBoundsThatNoRobotHas) {
  for (const char* keys :
       {"value = [1.0, 1e200]", "value = [1.0, 2.0]\nmomentum_error = [0.0, 1e200]",
        "value = [1.0, 0.0]\nover_speed = [{joint = 2, at = [0.0, 1e200], value = [1.0, 2.0]}]",
        "value = [1.0, 0.0]\nover_speed = [{joint = 2, at = [0.0, 1.0], value = [1.0, 1e200]}]"}) {
    EXPECT_THAT(space_refusal(in_torque_space("[uncertainty_bound]\nkind = \"per_joint\"\n" +
                                              std::string(keys) + "\n")),
                AllOf(ContainsRegex("r.toml: line [0-9]+, uncertainty_bound.*: found 1e.200"),
                      HasSubstr(": no robot has more; to mend: look at its unit")))
        << keys;
  }
  const std::string sample = test::kSampleRobot;
  const std::string head = sample.substr(0, sample.find("[uncertainty_bound]"));
  for (const char* keys :
       {"kind = \"constant\"\nvalue = 1e200",
        "kind = \"constant\"\nvalue = 1\nvelocity_error = 1e200",
        "kind = \"scaled_norm\"\nscale = 1e200\noffset = 1\nmatrix = [[1, 1]]",
        "kind = \"scaled_norm\"\nscale = 1\noffset = 1e200\nmatrix = [[1, 1]]",
        "kind = \"scaled_norm\"\nscale = 1\noffset = 1\nmatrix = [[1, -1e200]]",
        "kind = \"table\"\nvariable = \"speed\"\njoint = 1\nat = [0, 1]\nvalue = [1, 1e200]"}) {
    EXPECT_THAT(space_refusal(head + "[uncertainty_bound]\n" + keys + "\n"),
                HasSubstr("no robot has more"))
        << keys;
  }
  for (const char* line :
       {"learning_rate = 0.5", "weight_radius = 3.0", "initial_weight_range = 0.2"}) {
    const std::string key = std::string(line).substr(0, std::string(line).find(' '));
    EXPECT_THAT(space_refusal(test::changed(sample, line, key + " = 1e200")),
                AllOf(HasSubstr("estimator." + key), HasSubstr("no robot has more")));
  }
}

TEST(RobotFile, SaysWhetherItsBoundCoversVelocities) {
  const std::string bound = "[uncertainty_bound]\nkind = \"per_joint\"\nvalue = [1.0, 2.0]\n";
  EXPECT_FALSE(parse_robot(in_torque_space(bound), "arm.toml").bound->covers_velocities);
  const RobotDescription robot =
      parse_robot(in_torque_space(bound + "covers_velocities = true\n"), "arm.toml");
  EXPECT_TRUE(robot.bound->covers_velocities);
  EXPECT_TRUE(parse_robot(robot_text(robot), "arm.toml").bound->covers_velocities);
}

TEST(RobotFile, InTorqueSpaceHasTheBoundThatAControllerNeeds) {
  const std::string per_joint = "[uncertainty_bound]\nkind = \"per_joint\"\nvalue = [1.0, 2.0]\n";
  EXPECT_NO_THROW(require_bound(parse_robot(in_torque_space(per_joint), "arm.toml"), "arm.toml"));
  EXPECT_THROW(require_bound(parse_robot(in_torque_space(""), "arm.toml"), "arm.toml"), InputError);
}

}  // namespace
}  // namespace offnominal::desk
