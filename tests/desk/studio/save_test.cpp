#include "studio/save.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "common/json_text.hpp"
#include "common/refused.hpp"
#include "compare/compare.hpp"
#include "desk/studio/studio_input.hpp"
#include "desk/support/temporary_folder.hpp"
#include "identify/add.hpp"
#include "studio/commands.hpp"
#include "studio/state_json.hpp"

namespace {

using offnominal::EffectKind;
using offnominal::test::content_of;
using offnominal::test::studio_input;
using offnominal::test::TemporaryFolder;
using namespace offnominal::desk;
using namespace offnominal::desk::studio;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

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

// What one fit leaves for the next changes nothing.
TEST_P(StudioSave, FitsOneAfterTheOtherAsOneAlone) {
  Input input = studio_input(folder_ / "arm.toml", GetParam());
  Treated recordings = *input.recordings;
  recordings.logs.push_back(recordings.logs[0]);
  recordings.logs[1].file = "loaded.csv";
  recordings.logs[1].payload = Payload{0.4, {0.1, 0, 0}};
  if (GetParam()) recordings.holdout[0].payload = Payload{0.2, {0.1, 0, 0}};
  input.recordings = std::make_shared<const Treated>(std::move(recordings));
  Workbench bench(input);
  const auto expect_same = [&] {
    RobotDescription robot = input.robot;
    for (std::size_t i = 0; i < bench.steps().size(); ++i) {
      AddRequest request;
      request.effects = {bench.steps()[i].kind};
      request.joint = bench.steps()[i].joint;
      request.source = input.source;
      const AddResult alone =
          add(robot, request, input.recordings->logs, input.recordings->holdout);
      const AddResult& here = bench.fitted(i).result;
      EXPECT_EQ(robot_text(here.robot), robot_text(alone.robot));
      ASSERT_EQ(here.held_out.size(), alone.held_out.size());
      for (std::size_t j = 0; j < alone.held_out.size(); ++j) {
        EXPECT_EQ(here.held_out[j].before_percent, alone.held_out[j].before_percent);
        EXPECT_EQ(here.held_out[j].after_percent, alone.held_out[j].after_percent);
      }
      for (std::size_t j = 0; j < alone.fitted_logs.size(); ++j) {
        EXPECT_EQ(here.fitted_logs[j].before_percent, alone.fitted_logs[j].before_percent);
        EXPECT_EQ(here.fitted_logs[j].after_percent, alone.fitted_logs[j].after_percent);
      }
      robot = alone.robot;
    }
  };
  bench.add(EffectKind::kViscousFriction, 1);
  bench.add(EffectKind::kTorqueOffset, 0);
  bench.add(EffectKind::kCoulombFriction, 1);
  expect_same();
  bench.undo(bench.steps()[0].id);
  bench.add(EffectKind::kViscousFriction, 1);
  EXPECT_EQ(bench.steps().size(), 3U);
  expect_same();
}

// The numbers of a step are its own fit's, and its words are no word on a file.
TEST_P(StudioSave, SaysOfAStepWhatAddPrints) {
  Workbench bench(studio_input(folder_ / "arm.toml", GetParam()));
  bench.add(EffectKind::kViscousFriction, 1);
  bench.add(EffectKind::kCoulombFriction, 1);
  bench.add(EffectKind::kTorqueOffset, 1);
  const auto steps = state_of(bench).at("steps");
  for (std::size_t i = 0; i < 3; ++i) {
    const AddResult& result = bench.fitted(i).result;
    const auto own = std::find_if(result.held_out.begin(), result.held_out.end(),
                                  [](const BeforeAfter& one) { return one.joint == 1; });
    ASSERT_NE(own, result.held_out.end());
    EXPECT_EQ(steps[i].at("before").at("held_out_percent").get<double>(), own->before_percent);
    EXPECT_EQ(steps[i].at("after").at("held_out_percent").get<double>(), own->after_percent);
  }
  ASSERT_FALSE(bench.fitted(2).result.doubts.empty());
  const std::string verdict = steps[2].at("verdict").get<std::string>();
  EXPECT_THAT(verdict, HasSubstr("data not used for the fit"));
  EXPECT_THAT(verdict, Not(HasSubstr("ritten")));
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

TEST_F(StudioPlace, SaysCommandsThatWriteNoFileThatIsThere) {
  // A robot file that is called as an intermediate one would be.
  Input input = studio_input(folder_ / "found_1.toml", true);
  Workbench bench(input);
  bench.add(EffectKind::kViscousFriction, 1);
  bench.add(EffectKind::kCoulombFriction, 1);
  const std::string found = (folder_ / "found.toml").string();
  auto commands = commands_of(bench, found);
  ASSERT_EQ(commands.size(), 3U);
  EXPECT_THAT(commands[0], EndsWith(" -o " + (folder_ / "found_1_2.toml").string()));
  EXPECT_THAT(commands[1], HasSubstr(" --robot " + (folder_ / "found_1_2.toml").string() + " "));
  EXPECT_THAT(commands[1], EndsWith(" -o " + found));
  // Once it is saved, `add` would refuse that name.
  save(bench, {.name = "found.toml"});
  commands = commands_of(bench, found);
  const std::string again = (folder_ / "found_again.toml").string();
  EXPECT_THAT(commands[1], EndsWith(" -o " + again));
  EXPECT_EQ(commands[2], "offnominal compare fitted.csv --robot " + again);
}

TEST_F(StudioPlace, SaysAPayloadWhereItsRecordingIsRead) {
  Input input = studio_input(folder_ / "arm.toml", true);
  input.payloads = {{"fitted.csv", {0.5, {0, 0, 0.1}}}, {"held_out.csv", {0.7, {0, 0, 0.1}}}};
  Workbench bench(input);
  bench.add(EffectKind::kViscousFriction, 1);
  const auto commands = commands_of(bench, "a.toml");
  EXPECT_THAT(commands[0], EndsWith(" -o a.toml --payload fitted.csv=0.5@0,0,0.1 --payload "
                                    "held_out.csv=0.7@0,0,0.1"));
  EXPECT_THAT(commands[1], EndsWith(" --robot a.toml --payload fitted.csv=0.5@0,0,0.1"));
}

TEST_F(StudioPlace, ProposesANameThatItTakesForAnyRobotFile) {
  Input input = bench_.input();
  const std::string folder = (folder_ / "").string();
  std::string accents = "x";
  for (int i = 0; i < 100; ++i) accents += "\xc3\xa9";
  for (const std::string& name :
       {std::string(".hidden.toml"), std::string(200, 'a') + ".toml", accents + ".toml",
        std::string("a\nb\\c.toml"), std::string("..toml"), std::string("\xff.toml")}) {
    input.robot_file = folder + name;
    const std::string proposed = proposed_name(input);
    EXPECT_NO_THROW(static_cast<void>(place_to_save(input, ""))) << proposed;
    EXPECT_THAT(proposed, EndsWith("_studio.toml"));
    EXPECT_EQ(as_utf8(proposed), proposed);
  }
}

TEST_F(StudioPlace, RefusesAnEffectThatIsThereAndChangesNothing) {
  bench_.add(EffectKind::kViscousFriction, 1);
  EXPECT_FALSE(bench_.why_not(EffectKind::kViscousFriction, 1).empty());
  EXPECT_ANY_THROW(bench_.add(EffectKind::kViscousFriction, 1));
  EXPECT_THROW(bench_.undo(99), Refused);
  EXPECT_EQ(bench_.steps().size(), 1U);
}

}  // namespace
