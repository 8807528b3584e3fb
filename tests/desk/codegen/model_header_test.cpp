#include "codegen/model_header.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <offnominal/version.hpp>
#include <string>

#include "common/error.hpp"
#include "desk/robot/sample_robot.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {
namespace {

using test::changed;
using testing::HasSubstr;
using testing::Not;

ModelHeader header_of(const std::string& text, const ModelHeaderOptions& options = {}) {
  return model_header(parse_robot(text, "sample.toml"), options);
}

TEST(ModelHeader, SaysWhereItComesFromAndInWhatUnits) {
  const ModelHeader header = header_of(test::kSampleRobot, {.robot_file = "/some/where/arm.toml"});
  EXPECT_THAT(header.text, HasSubstr("from arm.toml."));
  EXPECT_THAT(header.text, Not(HasSubstr("/some")));
  EXPECT_THAT(header.text,
              HasSubstr("version " + std::to_string(kVersionMajor) + "." +
                        std::to_string(kVersionMinor) + "." + std::to_string(kVersionPatch)));
  EXPECT_THAT(header.text,
              HasSubstr("joint 1 moves in rad and is driven in N m, joint 2 moves in m"));
  EXPECT_THAT(header.text, HasSubstr(".max_velocity = Scalar(4.0),  // rad/s, magnitude\n"));
  EXPECT_THAT(header.text, HasSubstr("coefficient in N s/m\n"));
  EXPECT_THAT(header.text, HasSubstr("joint 1: turn; drawing 12"));
  EXPECT_EQ(header.joints, 2);
  EXPECT_EQ(header.effects, 2);
  EXPECT_EQ(header.hidden_units, 12);
  EXPECT_EQ(header.in_float, Status::kOk);
}

TEST(ModelHeader, RepeatsToTheLetter) {
  EXPECT_EQ(header_of(test::kSampleRobot).text, header_of(test::kSampleRobot).text);
}

TEST(ModelHeader, OffersDoubleAloneWhereFloatWouldBeRefused) {
  // The initial weights have to be inside the radius, or the file is refused.
  const std::string weights =
      changed(test::kSampleRobot, "initial_weight_range = 0.2", "initial_weight_range = 1e-63");
  const ModelHeader header =
      header_of(changed(weights, "weight_radius = 3.0", "weight_radius = 1e-60"));
  EXPECT_EQ(header.in_float, Status::kInvalidWeightRadius);
  EXPECT_THAT(header.text, HasSubstr("For double only: rounded to float"));
  EXPECT_THAT(header.text, HasSubstr("template <std::same_as<double> Scalar>"));
  const ModelHeader pole =
      header_of(changed(test::kSampleRobot, "alpha_per_s = 20.0", "alpha_per_s = 1e-60"));
  EXPECT_EQ(pole.in_float, Status::kInvalidFilterPole);
}

// The sample with its monitor in torque space.
std::string by_joint(const std::string& bound) {
  std::string text = changed(test::kSampleRobot, "seed = 7", "seed = 7\nspace = \"torque\"");
  const auto begin = text.find("[uncertainty_bound]");
  text.replace(begin, text.find("[channels]") - begin, bound);
  return text;
}

TEST(ModelHeader, InTorqueSpaceHasABoundOfEveryJointInItsUnit) {
  const ModelHeader header =
      header_of(by_joint("[uncertainty_bound]\nkind = \"per_joint\"\nvalue = [1.5, 0.0]\n"
                         "over_speed = [{joint = 2, at = [0.0, 0.5], value = [2.0, 3.0]}]\n"
                         "momentum_error = [0.25, 0.0]\n"));
  EXPECT_THAT(header.text, HasSubstr("using Space = offnominal::TorqueSpace;\n"));
  EXPECT_THAT(header.text, HasSubstr("constexpr offnominal::TorqueBound<kJoints, Scalar> kBound"));
  EXPECT_THAT(
      header.text,
      HasSubstr("constexpr offnominal::MonitorConfig<kJoints, Scalar, Space> kMonitorConfig"));
  EXPECT_THAT(header.text, HasSubstr(".points = 1,\n"));
  EXPECT_THAT(header.text, HasSubstr(".value = {Scalar(1.5)},  // N m\n"));
  EXPECT_THAT(header.text, HasSubstr(".momentum_error = Scalar(0.25),  // N m s\n"));
  EXPECT_THAT(header.text, HasSubstr(".at = {Scalar(0.0), Scalar(0.5)},  // m/s\n"));
  EXPECT_THAT(header.text, HasSubstr(".value = {Scalar(2.0), Scalar(3.0)},  // N\n"));
  EXPECT_EQ(header.in_float, Status::kOk);
  const ModelHeader plain = header_of(test::kSampleRobot);
  EXPECT_THAT(plain.text, HasSubstr("using Space = offnominal::AccelerationSpace;\n"));
}

TEST(ModelHeader, InTorqueSpaceOffersDoubleAloneWhereFloatWouldBeRefused) {
  const ModelHeader header =
      header_of(by_joint("[uncertainty_bound]\nkind = \"per_joint\"\nvalue = [1.5, 1e-60]\n"));
  EXPECT_EQ(header.in_float, Status::kInvalidBound);
  EXPECT_THAT(header.text, HasSubstr("template <std::same_as<double> Scalar>"));
}

std::string refusal_of(const std::string& text, const ModelHeaderOptions& options) {
  try {
    static_cast<void>(header_of(text, options));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ModelHeader, RefusesARobotWithoutABoundAndANamespaceThatIsNone) {
  std::string without = test::kSampleRobot;
  const auto begin = without.find("[uncertainty_bound]");
  without.erase(begin, without.find("[channels]") - begin);
  EXPECT_THAT(refusal_of(without, {.robot_file = "a.toml"}),
              HasSubstr("a.toml: uncertainty_bound: found nothing; allowed: a table"));
  EXPECT_THAT(refusal_of(test::kSampleRobot, {.name_space = "my-arm"}),
              HasSubstr("--namespace: found my-arm; allowed: names of letters"));
}

}  // namespace
}  // namespace offnominal::desk
