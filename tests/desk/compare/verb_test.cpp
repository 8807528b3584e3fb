#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/number.hpp"
#include "desk/support/run_command.hpp"
#include "desk/support/temporary_folder.hpp"
#include "recorded_arm.hpp"
#include "robot/robot_file.hpp"
#include "support/places.hpp"

// `offnominal compare` and `offnominal add` as a user runs them, on a simulated arm.

namespace {

using Eigen::Vector2d;
using offnominal::EffectKind;
using offnominal::desk::Log;
using offnominal::desk::read_robot_file;
using offnominal::desk::shortest;
using offnominal::test::arm_description;
using offnominal::test::ArmInstant;
using offnominal::test::CommandResult;
using offnominal::test::content_of;
using offnominal::test::put;
using offnominal::test::record_arm;
using offnominal::test::TemporaryFolder;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class Verbs : public ::testing::Test {
 protected:
  void SetUp() override {
    offnominal::desk::write_robot_file(arm_description(), folder_ / "arm.toml");
    put(folder_ / "arm.csv", csv(1));
    put(folder_ / "other.csv", csv(0.7));
  }

  static std::string csv(double amplitude, double duration_s = 12) {
    const Log log = record_arm(
        {.duration_s = duration_s, .rate_hz = 500, .torque_noise = 0.05, .amplitude = amplitude},
        [](const ArmInstant& at) { return Vector2d(0, 0.8 * at.dq[1] + 0.3); });
    std::string text = "t,q1,q2,tau1,tau2\n";
    for (Eigen::Index i = 0; i < log.sample_count(); ++i) {
      for (const double value : {log.t_s[i], log.q(i, 0), log.q(i, 1), log.tau(i, 0)}) {
        text += shortest(value) + ",";
      }
      text += shortest(log.tau(i, 1)) + "\n";
    }
    return text;
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  static CommandResult run(const std::vector<std::string>& arguments) {
    return offnominal::test::run_command(offnominal::test::command_file(), arguments);
  }
  CommandResult compare(std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"compare", path("arm.csv"), "--robot", path("arm.toml")});
    return run(more);
  }
  CommandResult add(const std::string& effect, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"add", effect, "--joint", "2", "--robot", path("arm.toml"), "--log",
                               path("arm.csv"), "-o", path("new.toml")});
    return run(more);
  }
  bool written() const { return std::filesystem::exists(folder_ / "new.toml"); }

  TemporaryFolder folder_;
};

void expect_refusal(const CommandResult& result, const std::string& words) {
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(result.err, HasSubstr(words));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
}

TEST_F(Verbs, CompareSpeaksToPeopleAndToMachines) {
  const CommandResult text = compare();
  EXPECT_EQ(text.exit_code, 0);
  EXPECT_EQ(text.err, "");
  EXPECT_THAT(text.out, AllOf(HasSubstr("relative error"), HasSubstr("Joint 2: good")));

  const CommandResult json = compare({"--json"});
  const auto object = nlohmann::json::parse(json.out);
  ASSERT_EQ(object.at("joints").size(), 2U);
  EXPECT_LT(object.at("joints").at(0).at("relative_error_percent"), 1.5);
  EXPECT_GT(object.at("joints").at(1).at("relative_error_percent"), 3);
  EXPECT_EQ(compare({"--json"}).out, json.out) << "same input, same bytes";
}

TEST_F(Verbs, CompareWritesAPageThatSaysWhatTheJsonSays) {
  const CommandResult result = compare({"--json", "--report", path("page.html")});
  const std::string page = content_of(folder_ / "page.html");
  const auto object = nlohmann::json::parse(result.out);
  EXPECT_THAT(page, HasSubstr(object.at("verdict").get<std::string>()));
  EXPECT_THAT(page, HasSubstr("residual over velocity"));
  // The command can be run again as the page has it: a flag has no value.
  EXPECT_THAT(page, AllOf(HasSubstr("--json"), Not(HasSubstr("--json true"))));
}

// What a page draws from: the JSON in it.
nlohmann::json data_of(const std::string& page) {
  const auto script = page.find("id=\"data\"");
  const auto begin = page.find('>', script) + 1;
  return nlohmann::json::parse(page.substr(begin, page.find("</script>", begin) - begin));
}

// The rows of the table with that caption, wherever it stands on the page.
nlohmann::json rows_of(const nlohmann::json& data, const std::string& caption) {
  if (data.is_object() && data.value("caption", "") == caption && data.contains("rows")) {
    return data.at("rows");
  }
  for (const nlohmann::json& inner : data) {
    if (!inner.is_structured()) continue;
    if (nlohmann::json rows = rows_of(inner, caption); !rows.is_null()) return rows;
  }
  return {};
}

TEST_F(Verbs, CompareShowsTheSameNumbersOnThePageAsInTheJson) {
  const auto json = nlohmann::json::parse(compare({"--json", "--report", path("page.html")}).out);
  const auto rows = rows_of(data_of(content_of(folder_ / "page.html")), "Error per joint");
  ASSERT_EQ(rows.size(), 2U);
  for (std::size_t joint = 0; joint < 2; ++joint) {
    const auto& said = json.at("joints").at(joint);
    const nlohmann::json expected{said.at("joint"),
                                  said.at("rms_error"),
                                  said.at("rms_torque"),
                                  said.at("unit"),
                                  said.at("relative_error_percent"),
                                  said.at("fit_percent")};
    EXPECT_EQ(rows.at(joint), expected);
  }
}

TEST_F(Verbs, CompareAgainstAnOlderFileSaysHowFarTheErrorFell) {
  ASSERT_EQ(add("viscous_friction").exit_code, 0);
  const CommandResult result =
      run({"compare", path("other.csv"), "--robot", path("new.toml"), "--against", path("arm.toml"),
           "--json", "--report", path("fall.html")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  const auto& now = json.at("joints").at(1);
  const auto& before = json.at("against").at("joints").at(1);
  const double fall = 1 - now.at("rms_error").get<double>() / before.at("rms_error").get<double>();
  EXPECT_GT(fall, 0.4);
  EXPECT_NEAR(before.at("fall_percent").get<double>(), 100 * fall, 1e-9);
  // The same older model by itself gives the same number.
  const auto alone = nlohmann::json::parse(
      run({"compare", path("other.csv"), "--robot", path("arm.toml"), "--json"}).out);
  EXPECT_EQ(alone.at("joints").at(1).at("rms_error"), before.at("rms_error"));
  const auto rows = rows_of(data_of(content_of(folder_ / "fall.html")), "Fall of the error");
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows.at(1).at(6), before.at("fall_percent"));

  const CommandResult text = run(
      {"compare", path("other.csv"), "--robot", path("new.toml"), "--against", path("arm.toml")});
  EXPECT_THAT(text.out, AllOf(HasSubstr("Joint 2: the error falls from"), HasSubstr("arm.toml")));
}

// One file on one recording has one error, whoever tells it; on parts that no fit has seen, too.
TEST_F(Verbs, TellTheSameErrorsOfAFile) {
  put(folder_ / "long.csv", csv(1, 40));
  const auto json_of_run = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--robot", path("arm.toml"), "--json"});
    return nlohmann::json::parse(run(arguments).out);
  };
  const auto joint_of = [](const nlohmann::json& of) { return of.at("joints").at(1); };
  const auto errors = [](const nlohmann::json& of, const char* before, const char* after) {
    return std::pair{of.at(before).get<double>(), of.at(after).get<double>()};
  };
  for (const bool apart : {false, true}) {
    const std::vector<std::string> holdout =
        apart ? std::vector<std::string>{"--holdout", path("other.csv")}
              : std::vector<std::string>{};
    const auto with = [&](std::vector<std::string> arguments) {
      arguments.insert(arguments.end(), holdout.begin(), holdout.end());
      return json_of_run(std::move(arguments));
    };
    const auto name = [&](const char* file) { return path(file) + (apart ? ".apart" : ".parts"); };
    const auto explained = with({"explain", path("long.csv")});
    ASSERT_FALSE(explained.at("found").empty()) << explained.at("words");
    const auto all = with({"add", "--all-found", "--log", path("long.csv"), "-o", name("all")});
    std::vector<std::string> each{"add"};
    for (const auto& found : explained.at("found")) {
      ASSERT_EQ(found.at("joint"), 2);
      each.push_back(found.at("effect"));
    }
    each.insert(each.end(), {"--joint", "2", "--log", path("long.csv"), "-o", name("each")});
    const auto one = with(each);
    const auto [before, after] = errors(joint_of(explained), "rms_error_before", "rms_error_after");
    EXPECT_NEAR(joint_of(json_of_run({"compare", path("long.csv")})).at("rms_error"), before,
                1e-12 * before);
    const auto of_all = joint_of(all.at("recordings").at(0));
    EXPECT_NEAR(of_all.at("rms_error_before").get<double>(), before, 1e-12 * before);
    EXPECT_NEAR(of_all.at("rms_error_after").get<double>(), after, 1e-9 * after);
    const auto [held_before, held_after] =
        errors(joint_of(explained), "holdout_before", "holdout_after");
    const auto of_one = [&](const char* when) {
      return one.at(when).at("holdout").at("rms_error").get<double>();
    };
    EXPECT_NEAR(of_one("before"), held_before, 1e-9 * held_before);
    // `explain` fits the links' masses beside, `add EFFECT` does not.
    EXPECT_NEAR(of_one("after"), held_after, 0.1 * held_after);
    if (!apart) continue;
    EXPECT_NEAR(joint_of(json_of_run({"compare", path("other.csv")})).at("rms_error"), held_before,
                1e-12 * held_before);
    const auto of_held = joint_of(all.at("recordings").at(1));
    EXPECT_NEAR(of_held.at("rms_error_after").get<double>(), held_after, 1e-9 * held_after);
  }
}

TEST_F(Verbs, CompareRefusesAnOlderFileOfAnotherRobot) {
  auto other = arm_description();
  other.joints.pop_back();
  offnominal::desk::write_robot_file(other, folder_ / "one.toml");
  expect_refusal(compare({"--against", path("one.toml")}), "1 joints");
}

TEST_F(Verbs, AddAllFoundWritesWhatExplainFinds) {
  put(folder_ / "long.csv", csv(1, 40));
  const std::vector<std::string> arguments{
      "add",   "--all-found",    "--robot",   path("arm.toml"),  "--log",     path("long.csv"),
      "-o",    path("new.toml"), "--holdout", path("other.csv"), "--threads", "2",
      "--json"};
  const CommandResult result = run(arguments);
  ASSERT_EQ(result.exit_code, 0) << result.err << result.out;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json.at("verdict"), "found");
  EXPECT_EQ(json.at("written"), path("new.toml"));
  const auto robot = read_robot_file(folder_ / "new.toml");
  double viscous = 0;
  for (const auto& effect : robot.effects) {
    EXPECT_TRUE(effect.fitted);
    EXPECT_THAT(effect.source, HasSubstr("long.csv"));
    if (effect.kind == EffectKind::kViscousFriction && effect.joint == 1) {
      viscous = effect.parameters[0];
    }
  }
  EXPECT_NEAR(viscous, 0.8, 0.04);
  for (const auto& recording : json.at("recordings")) {
    const auto& joint = recording.at("joints").at(1);
    EXPECT_LT(joint.at("rms_error_after").get<double>(),
              0.5 * joint.at("rms_error_before").get<double>());
  }
  EXPECT_EQ(json.at("recordings").at(1).at("held_out"), true);
  // The file is what compare says it is.
  const auto compared = nlohmann::json::parse(
      run({"compare", path("other.csv"), "--robot", path("new.toml"), "--json"}).out);
  EXPECT_NEAR(compared.at("joints").at(1).at("rms_error").get<double>(),
              json.at("recordings").at(1).at("joints").at(1).at("rms_error_after").get<double>(),
              1e-9);
  // Once it is in, nothing is missing, and nothing is written.
  auto again = arguments;
  again[3] = path("new.toml");
  again[7] = path("newer.toml");
  const CommandResult second = run(again);
  EXPECT_EQ(second.exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "newer.toml"));
  EXPECT_EQ(nlohmann::json::parse(second.out).at("verdict"), "explained") << second.out;
}

TEST_F(Verbs, AddAllFoundRefusesWhatOnlyANamedEffectTakes) {
  const std::vector<std::string> base{"add",   "--all-found",   "--robot", path("arm.toml"),
                                      "--log", path("arm.csv"), "-o",      path("new.toml")};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), base.begin(), base.end());
    return run(more);
  };
  expect_refusal(with({"--joint", "1"}), "--all-found");
  expect_refusal(with({"viscous_friction"}), "--all-found");
  expect_refusal(with({"--cutoff", "20"}), "--all-found");
  expect_refusal(with({"--set", "smoothing=1"}), "--all-found");
  expect_refusal(
      run({"add", "--robot", path("arm.toml"), "--log", path("arm.csv"), "-o", path("new.toml")}),
      "EFFECT");
  EXPECT_FALSE(written());
}

TEST_F(Verbs, AddShowsTheSameNumbersOnThePageAsInTheJson) {
  const auto json =
      nlohmann::json::parse(add("viscous_friction", {"--holdout", path("other.csv"), "--json",
                                                     "--report", path("add.html")})
                                .out);
  const auto data = data_of(content_of(folder_ / "add.html"));
  const auto parameters = rows_of(data, "Parameters");
  ASSERT_EQ(parameters.size(), 1U);
  const auto& said = json.at("parameters").at("coefficient");
  EXPECT_EQ(parameters.at(0).at(3), said.at("value"));
  EXPECT_EQ(parameters.at(0).at(4), said.at("ci95").at(0));
  EXPECT_EQ(parameters.at(0).at(5), said.at("ci95").at(1));
  EXPECT_EQ(parameters.at(0).at(6), said.at("unit"));
  const auto errors = rows_of(data, "Error before and after");
  ASSERT_EQ(errors.size(), 4U) << "two joints in each recording";
  // The JSON speaks of the joint that the effect acts on.
  for (const auto& [row, part] :
       {std::pair{std::size_t{1}, "fit"}, std::pair{std::size_t{3}, "holdout"}}) {
    const char* const percent = "relative_error_percent";
    EXPECT_EQ(errors.at(row).at(1), 2);
    EXPECT_EQ(errors.at(row).at(5), json.at("before").at(part).at(percent)) << part;
    EXPECT_EQ(errors.at(row).at(6), json.at("after").at(part).at(percent)) << part;
  }
}

TEST_F(Verbs, CompareTakesChannelsFromAFile) {
  std::string renamed = content_of(folder_ / "arm.csv");
  renamed.replace(0, renamed.find('\n'), "time,a,b,c,d");
  put(folder_ / "arm.csv", renamed);
  expect_refusal(compare(), "time, a, b, c, d");
  put(folder_ / "map.toml",
      "time = 'time'\nposition = ['a', 'b']\ntorque = ['c', {source = 'd', scale = 2}]\n");
  const auto object =
      nlohmann::json::parse(compare({"--json", "--channels", path("map.toml")}).out);
  EXPECT_LT(object.at("joints").at(0).at("relative_error_percent"), 1.5);
  EXPECT_GT(object.at("joints").at(1).at("relative_error_percent"), 45);
}

TEST_F(Verbs, CompareRefusesWhatItCannotUse) {
  expect_refusal(run({"compare", path("none.csv"), "--robot", path("arm.toml")}), "no such file");
  expect_refusal(run({"compare", path("arm.csv"), "--robot", path("none.toml")}), "none.toml");
  expect_refusal(compare({"--cutoff", "400"}), "half the sampling rate");
  expect_refusal(compare({"--decimate", "100000"}), "a recording of");
  expect_refusal(compare({"--report", path("no/folder/page.html")}), "page.html");
  put(folder_ / "arm.csv", "t,q1,q2,tau1,tau2\n0,1,2,3\n");
  expect_refusal(compare(), "line 2");
}

TEST_F(Verbs, AddWritesARobotFileThatIsBetter) {
  const CommandResult result =
      add("viscous_friction", {"torque_offset", "--holdout", path("other.csv"), "--json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto object = nlohmann::json::parse(result.out);
  EXPECT_EQ(object.at("effect"), "viscous_friction");
  EXPECT_EQ(object.at("joint"), 2);
  const auto& coefficient = object.at("parameters").at("coefficient");
  EXPECT_NEAR(coefficient.at("value").get<double>(), 0.8, 0.01);
  EXPECT_EQ(coefficient.at("unit"), "N m s/rad");
  EXPECT_LT(coefficient.at("ci95").at(0), coefficient.at("value"));
  EXPECT_EQ(object.at("also").at(0).at("effect"), "torque_offset");
  for (const char* data : {"fit", "holdout"}) {
    const double before = object.at("before").at(data).at("relative_error_percent");
    const double after = object.at("after").at(data).at("relative_error_percent");
    EXPECT_LT(after, 0.1 * before) << data;
  }
  EXPECT_EQ(object.at("holdout").at("kind"), "recording");
  EXPECT_EQ(object.at("written"), path("new.toml"));

  const auto robot = read_robot_file(folder_ / "new.toml");
  ASSERT_EQ(robot.effects.size(), 2U);
  EXPECT_EQ(robot.effects[0].parameters[0], coefficient.at("value"));
  EXPECT_TRUE(robot.effects[0].fitted);
  EXPECT_EQ(robot.effects[0].source, "Fitted to arm.csv by offnominal add.");
  const auto after = nlohmann::json::parse(
      run({"compare", path("arm.csv"), "--robot", path("new.toml"), "--json"}).out);
  EXPECT_NEAR(after.at("joints").at(1).at("relative_error_percent").get<double>(),
              object.at("after").at("fit").at("relative_error_percent").get<double>(), 1e-9);
}

TEST_F(Verbs, AddWithoutHoldOutHoldsOutPartsAndWritesAPage) {
  const CommandResult result = add("viscous_friction", {"--report", path("add.html")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("held-out parts"), HasSubstr("falls from"),
                                HasSubstr("written: " + path("new.toml"))));
  EXPECT_THAT(content_of(folder_ / "add.html"), HasSubstr("predicted by a fit of the others"));
}

TEST_F(Verbs, AddLeavesTheRobotFileAloneUnlessForced) {
  const std::string before = content_of(folder_ / "arm.toml");
  const std::vector<std::string> onto_itself{
      "add",     "viscous_friction", "--joint", "2",
      "--robot", path("arm.toml"),   "--log",   path("arm.csv"),
      "-o",      path("arm.toml")};
  expect_refusal(run(onto_itself), "--force");
  EXPECT_EQ(content_of(folder_ / "arm.toml"), before);
  auto forced = onto_itself;
  forced.emplace_back("--force");
  EXPECT_EQ(run(forced).exit_code, 0);
  EXPECT_EQ(read_robot_file(folder_ / "arm.toml").effects.size(), 1U);
}

TEST_F(Verbs, AddReplacesNoFileUnlessForced) {
  put(folder_ / "new.toml", "somebody's work");
  expect_refusal(add("viscous_friction"), path("new.toml") + ", which is there already");
  EXPECT_EQ(content_of(folder_ / "new.toml"), "somebody's work");
  EXPECT_EQ(add("viscous_friction", {"--force"}).exit_code, 0);
  EXPECT_EQ(read_robot_file(folder_ / "new.toml").effects.size(), 1U);
}

TEST_F(Verbs, AddThatTheDataDoNotSupportIsWrittenByForceAlone) {
  const CommandResult refused = add("torque_offset");
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.out, AllOf(HasSubstr("does not fall"), HasSubstr("Nothing was written")));
  EXPECT_FALSE(written());
  const CommandResult forced = add("torque_offset", {"--force"});
  EXPECT_EQ(forced.exit_code, 0) << forced.err;
  EXPECT_THAT(forced.out, HasSubstr("Written all the same, as --force says"));
  EXPECT_TRUE(written());
}

TEST_F(Verbs, AddThatTheDataDoNotAllowWritesNothingAndExitsWithOne) {
  ASSERT_EQ(add("torque_offset", {"--force"}).exit_code, 0);
  std::filesystem::rename(folder_ / "new.toml", folder_ / "arm.toml");
  auto robot = read_robot_file(folder_ / "arm.toml");
  robot.effects.push_back(offnominal::test::effect_of(EffectKind::kLinkMass, 1, {0.0}, true));
  std::filesystem::remove(folder_ / "arm.toml");
  offnominal::desk::write_robot_file(robot, folder_ / "arm.toml");
  const CommandResult result = add("tip_payload", {"--set", "x=1", "--json"});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  const auto object = nlohmann::json::parse(result.out);
  EXPECT_TRUE(object.at("written").is_null());
  EXPECT_THAT(object.at("objections").at(0).get<std::string>(), HasSubstr("cannot tell"));
  EXPECT_FALSE(written());
}

TEST_F(Verbs, AddRefusesWhatItCannotUse) {
  expect_refusal(add("viscos_friction"), "write viscous_friction");
  expect_refusal(add("viscous_friction", {"--set", "coefficient"}), "NAME=NUMBER");
  expect_refusal(add("viscous_friction", {"--set", "speed=1"}), "allowed: coefficient");
  expect_refusal(add("viscous_friction", {"--refit-inertia", "0"}), "--refit-inertia");
  expect_refusal(add("viscous_friction", {"--holdout", path("arm.csv")}), "the same as");
  expect_refusal(run({"add", "viscous_friction", "--joint", "3", "--robot", path("arm.toml"),
                      "--log", path("arm.csv"), "-o", path("new.toml")}),
                 "1 to 2");
  expect_refusal(run({"add", "viscous_friction", "--joint", "2", "--robot", path("arm.toml"),
                      "--log", path("arm.csv"), "-o", path("arm.csv"), "--force"}),
                 "which is that of --log");
  expect_refusal(run({"add", "viscous_friction", "--joint", "2", "--robot", path("arm.toml"),
                      "--log", path("arm.csv"), "-o", path("no/folder/new.toml")}),
                 "new.toml");
  EXPECT_FALSE(written());
}

TEST_F(Verbs, HelpListsEveryEffectWithItsFormula) {
  const CommandResult result = run({"add", "--help"});
  for (const auto& info : offnominal::kAllEffectInfos) {
    EXPECT_THAT(result.out, AllOf(HasSubstr(info.name), HasSubstr(info.formula)));
  }
}

}  // namespace
