#include "studio/save.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "compare/compare.hpp"
#include "desk/studio/studio_input.hpp"
#include "desk/support/temporary_folder.hpp"
#include "identify/add.hpp"
#include "studio/commands.hpp"
#include "studio/refused.hpp"

namespace {

using offnominal::EffectKind;
using offnominal::test::content_of;
using offnominal::test::studio_input;
using offnominal::test::TemporaryFolder;
using namespace offnominal::desk;
using namespace offnominal::desk::studio;

// As `offnominal add` does it: reads a file, adds, writes the next.
double add_by_files(const Input& input, EffectKind kind, const std::filesystem::path& from,
                    const std::filesystem::path& to) {
  AddRequest request;
  request.effects = {kind};
  request.joint = 1;
  request.source = input.source;
  const AddResult result =
      add(read_robot_file(from), request, input.recordings->logs, input.recordings->holdout);
  write_robot_file(result.robot, to);
  for (const BeforeAfter& one : result.held_out) {
    if (one.joint == 1) return one.after_percent;
  }
  return -1;
}

Refused::Why why(const Workbench& bench, const SaveRequest& request) {
  try {
    static_cast<void>(save(bench, request));
  } catch (const Refused& refused) {
    return refused.why();
  }
  ADD_FAILURE() << "saved";
  return Refused::Why::kBadRequest;
}

class StudioSave : public ::testing::TestWithParam<bool> {
 protected:
  TemporaryFolder folder_;
};

TEST_P(StudioSave, WritesWhatAddWritesToTheByteAndSaysItsNumbers) {
  const Input input = studio_input(folder_ / "arm.toml", GetParam());
  // A comment stays where it is.
  const std::string text = "# Ours.\n" + content_of(folder_ / "arm.toml");
  std::ofstream(folder_ / "arm.toml") << text;
  Input commented = input;
  commented.robot = read_robot_file(folder_ / "arm.toml");
  Workbench bench(commented);
  bench.add(EffectKind::kTorqueOffset, 0);
  bench.add(EffectKind::kViscousFriction, 1);
  bench.add(EffectKind::kCoulombFriction, 1);
  bench.undo(bench.steps()[0].id);
  const double viscous =
      add_by_files(input, EffectKind::kViscousFriction, folder_ / "arm.toml", folder_ / "one.toml");
  const double both =
      add_by_files(input, EffectKind::kCoulombFriction, folder_ / "one.toml", folder_ / "two.toml");
  EXPECT_EQ(bench.held_out_percent(1, 1), viscous);
  EXPECT_EQ(bench.held_out_percent(1, 2), both);
  EXPECT_EQ(save(bench, {}), folder_ / "arm_studio.toml");
  EXPECT_EQ(content_of(folder_ / "arm_studio.toml"), content_of(folder_ / "two.toml"));
  EXPECT_TRUE(content_of(folder_ / "arm_studio.toml").starts_with("# Ours.\n"));
  // `compare` of the saved file.
  const RobotDescription saved = read_robot_file(folder_ / "arm_studio.toml");
  const Comparison compared = compare(saved, measure(input.recordings->logs[0], saved));
  EXPECT_EQ(bench.fitted_percent(1, 2), compared.joints[1].relative_error_percent);
}

INSTANTIATE_TEST_SUITE_P(WithAndWithoutHoldOut, StudioSave, ::testing::Bool());

class StudioPlace : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  Workbench bench_{studio_input(folder_ / "arm.toml", true)};
};

TEST_F(StudioPlace, AsksBeforeAFileIsReplaced) {
  EXPECT_EQ(why(bench_, {}), Refused::Why::kNotNow);
  bench_.add(EffectKind::kViscousFriction, 1);
  std::ofstream(folder_ / "arm_studio.toml") << "mine";
  EXPECT_EQ(why(bench_, {}), Refused::Why::kMustConfirm);
  EXPECT_EQ(content_of(folder_ / "arm_studio.toml"), "mine");
  save(bench_, {.replace = true});
  EXPECT_NE(content_of(folder_ / "arm_studio.toml"), "mine");
}

TEST_F(StudioPlace, WritesBesideTheRobotFileAndNowhereElse) {
  bench_.add(EffectKind::kViscousFriction, 1);
  for (const char* name :
       {"../x.toml", "/tmp/x.toml", "x.txt", ".x.toml", "a/x.toml", "x\n.toml", "..", "\\x.toml"}) {
    EXPECT_EQ(why(bench_, {.name = name, .replace = true}), Refused::Why::kBadRequest) << name;
  }
  EXPECT_EQ(save(bench_, {.name = "<b>.toml"}), folder_ / "<b>.toml");
}

TEST_F(StudioPlace, WritesTheFileOfOAndNoOther) {
  Input input = studio_input(folder_ / "arm.toml", true);
  input.output = (folder_ / "out.toml").string();
  Workbench bench(input);
  bench.add(EffectKind::kViscousFriction, 1);
  EXPECT_EQ(why(bench, {.name = "other.toml"}), Refused::Why::kBadRequest);
  EXPECT_EQ(save(bench, {}), folder_ / "out.toml");
}

TEST_F(StudioPlace, SaysTheCommandsThatRepeatTheSession) {
  bench_.add(EffectKind::kViscousFriction, 1);
  bench_.add(EffectKind::kCoulombFriction, 1);
  const auto commands = commands_of(bench_, "it's.toml");
  ASSERT_EQ(commands.size(), 3U);
  const std::string robot = (folder_ / "arm.toml").string();
  EXPECT_EQ(commands[0], "offnominal add viscous_friction --joint 2 --robot " + robot +
                             " --log fitted.csv --holdout held_out.csv -o 'it'\\''s_1.toml'");
  EXPECT_EQ(commands[2], "offnominal compare fitted.csv --robot 'it'\\''s.toml'");
}

TEST_F(StudioPlace, RefusesAnEffectThatIsThereAndChangesNothing) {
  bench_.add(EffectKind::kViscousFriction, 1);
  EXPECT_FALSE(bench_.why_not(EffectKind::kViscousFriction, 1).empty());
  EXPECT_ANY_THROW(bench_.add(EffectKind::kViscousFriction, 1));
  EXPECT_THROW(bench_.undo(99), Refused);
  EXPECT_EQ(bench_.steps().size(), 1U);
}

}  // namespace
