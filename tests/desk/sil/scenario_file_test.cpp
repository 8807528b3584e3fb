#include "sil/scenario_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>

#include "common/error.hpp"
#include "common/file.hpp"
#include "desk/sil/serial_robot.hpp"
#include "desk/support/temporary_folder.hpp"

namespace offnominal::desk::sil {
namespace {

Scenario read(const std::string& text,
              const std::optional<RobotDescription>& plant = std::nullopt) {
  const test::TemporaryFolder folder;
  write_file_atomically(folder / "s.toml", text);
  return read_scenario(folder / "s.toml", plant);
}

std::string refusal(const std::string& text,
                    const std::optional<RobotDescription>& plant = std::nullopt) {
  try {
    read(text, plant);
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was refused";
}

TEST(ScenarioFile, HasWhatStandsInIt) {
  const Scenario scenario = read(R"(format = 1
duration_s = 12.5
accommodate = true
frames = "fd"
velocity = "observed"
encoder_bits_per_turn = 19
seed = 7
[[fault]]
kind = "encoder_bias"
begin_s = 3.0
end_s = 4.0
joint = 2
size = -0.1
[[fault]]
kind = "mass_loss"
begin_s = 5.0
size = 0.5
rate_per_s = 0.25
)");
  EXPECT_EQ(scenario.duration_s, 12.5);
  EXPECT_TRUE(scenario.accommodate);
  EXPECT_EQ(scenario.format, hal::FrameFormat::kFd);
  EXPECT_FALSE(scenario.sends_velocity);
  EXPECT_EQ(scenario.encoder_bits_per_turn, 19);
  EXPECT_EQ(scenario.seed, 7U);
  ASSERT_EQ(scenario.faults.size(), 2U);
  EXPECT_EQ(scenario.faults[0].kind, sim::FaultEventKind::kEncoderBias);
  EXPECT_EQ(scenario.faults[0].joint, 1);
  EXPECT_EQ(scenario.faults[0].size, -0.1);
  EXPECT_EQ(scenario.faults[0].end_s, 4.0);
  EXPECT_EQ(scenario.faults[1].rate_per_s, 0.25);
  EXPECT_TRUE(std::isinf(scenario.faults[1].end_s));
}

// GIVEN a plant with six joints THEN faults and hidden effects may be of the sixth, and what is
// written is read as the same.
TEST(ScenarioFile, IsForTheJointsOfItsPlant) {
  const RobotDescription plant = test::serial_robot(6);
  const std::string text = R"(format = 1
[[fault]]
kind = "disturbance_torque"
begin_s = 3.0
joint = 6
size = -2.5
[[fault]]
kind = "mass_loss"
begin_s = 4.0
joint = 5
size = 0.5
[[hidden]]
kind = "joint_stiffness"
joint = 6
stiffness = 2.5
)";
  Scenario scenario = read(text, plant);
  for (int pass = 0; pass < 2; ++pass) {
    ASSERT_EQ(scenario.faults.size(), 2U);
    EXPECT_EQ(scenario.faults[0].kind, sim::FaultEventKind::kDisturbanceTorque);
    EXPECT_EQ(scenario.faults[0].joint, 5);
    EXPECT_EQ(scenario.faults[0].size, -2.5);
    EXPECT_EQ(scenario.faults[1].joint, 4);
    ASSERT_EQ(scenario.hidden.size(), 1U);
    EXPECT_EQ(scenario.hidden[0].kind, EffectKind::kJointStiffness);
    EXPECT_EQ(scenario.hidden[0].joint, 5);
    EXPECT_EQ(scenario.hidden[0].parameters[0], 2.5);
    EXPECT_FALSE(scenario.format.has_value());
    scenario = read(scenario_text(scenario), plant);
  }
  EXPECT_THAT(refusal(text), testing::HasSubstr("line 5"));
  const std::string hidden = text.substr(text.find("[[hidden]]"));
  EXPECT_THAT(refusal("format = 1\n" + hidden), testing::HasSubstr("--plant FILE"));
}

TEST(ScenarioFile, SaysWhereItIsWrong) {
  using testing::AllOf;
  using testing::HasSubstr;
  EXPECT_THAT(refusal("format = 2\n"), HasSubstr("format"));
  EXPECT_THAT(refusal("format = 1\nspeed = 3\n"), HasSubstr("speed"));
  EXPECT_THAT(refusal("format = 1\n[[fault]]\nkind = \"mass_los\"\nbegin_s = 1\n"),
              AllOf(HasSubstr("line 3"), HasSubstr("mass_loss")));
  EXPECT_THAT(refusal("format = 1\n[[fault]]\nkind = \"bus_off\"\nbegin_s = 1\nsize = 2\n"),
              AllOf(HasSubstr("line 5"), HasSubstr("size")));
  EXPECT_THAT(refusal("format = 1\n[[fault]]\nkind = \"frame_loss\"\nbegin_s = 1\nsize = 2\n"),
              AllOf(HasSubstr("line 5"), HasSubstr("0 to 1")));
  EXPECT_THAT(refusal("format = 1\n[[fault]]\nkind = \"payload\"\nbegin_s = 1\nend_s = 2\n"),
              HasSubstr("end_s"));
  EXPECT_THAT(refusal("format = 1\n[[fault]]\nkind = \"encoder_stuck\"\nbegin_s = 1\n"),
              HasSubstr("joint"));
  EXPECT_THAT(refusal("format = 1\nfault = 3\n"), HasSubstr("fault"));
  EXPECT_THAT(refusal("format = \n"), HasSubstr("line 1"));
}

TEST(ScenarioFile, SaysWhereAFaultIsOutsideOfTheRun) {
  using testing::AllOf;
  using testing::HasSubstr;
  const std::string late =
      "format = 1\nduration_s = 2\n[[fault]]\nkind = \"payload\"\nbegin_s = 3\nsize = 1\n";
  EXPECT_THAT(refusal(late), AllOf(HasSubstr("line 5, fault[1].begin_s"), HasSubstr("0 to 2 s"),
                                   HasSubstr("to mend: begin earlier")));
  EXPECT_THAT(refusal("format = 1\n[[fault]]\nkind = \"bus_off\"\nbegin_s = 3\nend_s = 2\n"),
              AllOf(HasSubstr("line 5, fault[1].end_s"), HasSubstr("after its begin_s, 3 s"),
                    HasSubstr("to mend:")));
  // A run of another length than the file's.
  const test::TemporaryFolder folder;
  write_file_atomically(folder / "s.toml", late);
  EXPECT_EQ(read_scenario(folder / "s.toml", std::nullopt, 4.0).duration_s, 4.0);
}

TEST(ScenarioFile, SaysWhichFaultThePlantCannotHave) {
  EXPECT_THAT(
      refusal("format = 1\n[[fault]]\nkind = \"nonlinear\"\nbegin_s = 3\n", test::serial_robot(2)),
      testing::AllOf(testing::HasSubstr("line 3, fault[1].kind: found nonlinear, for robot serial"),
                     testing::HasSubstr("to mend:")));
}

TEST(ScenarioFile, KindsStandInTheOrderOfTheirNumbers) {
  for (std::size_t i = 0; i < sim::kFaultEventInfos.size(); ++i) {
    EXPECT_EQ(static_cast<std::size_t>(sim::kFaultEventInfos[i].kind), i);
    EXPECT_THAT(fault_kinds_text(), testing::HasSubstr(std::string(sim::kFaultEventInfos[i].name)));
  }
}

}  // namespace
}  // namespace offnominal::desk::sil
