#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "../compare/recorded_arm.hpp"
#include "common/number.hpp"
#include "desk/support/run_command.hpp"
#include "log/csv_text.hpp"
#include "robot/robot_file.hpp"
#include "support/places.hpp"

// Recordings as they come to the verbs: files, pipes, standard input, what never ends, and what was
// given twice.

namespace offnominal::desk {
namespace {

using test::CommandResult;
using test::put;
using testing::HasSubstr;
using testing::Not;
using Words = std::vector<std::string>;

class RecordingsOfVerbs : public testing::Test {
 protected:
  void SetUp() override {
    write_robot_file(test::arm_description(), folder_ / "arm.toml");
    put(folder_ / "a.csv", csv_text(test::record_arm({.duration_s = 6, .rate_hz = 200})));
    put(folder_ / "b.csv",
        csv_text(test::record_arm({.duration_s = 6, .rate_hz = 200, .amplitude = 0.8})));
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  CommandResult run(Words words, const std::string& in_from = "/dev/null") const {
    words.insert(words.end(), {"--robot", path("arm.toml")});
    return test::run_command(test::command_file(), std::move(words), {}, in_from);
  }
  // The command at the end of a pipe, as a shell makes it.
  CommandResult piped(const std::string& source, const std::string& recording) const {
    return test::run_command(
        "/bin/sh", {"-c", source + " | '" + test::command_file() + "' compare " + recording +
                              " --json --robot '" + path("arm.toml") + "'"});
  }
  static void expect_refusal(const CommandResult& result, const std::string& told) {
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_THAT(result.err, HasSubstr(told));
  }
  static nlohmann::json without_name(const std::string& out) {
    nlohmann::json json = nlohmann::json::parse(out);
    for (const char* key : {"log", "logs"}) json.erase(key);
    for (nlohmann::json& one : json["recordings"]) one.erase("log");
    return json;
  }

  test::TemporaryFolder folder_;
};

// What look proposes, pasted behind the robot file, is what it then says that this reads.
TEST_F(RecordingsOfVerbs, AreLookedAtAsTheyComeAndReadAsProposed) {
  EXPECT_THAT(run({"look", "-"}, path("a.csv")).out, HasSubstr("position = [{source = \"q1\"}"));
  EXPECT_THAT(run({"look", path("a.csv") + "+" + path("b.csv")}).out,
              HasSubstr("2 files joined on the samples of"));
  const CommandResult seen = run({"look", path("a.csv"), "--json"});
  ASSERT_EQ(seen.exit_code, 0) << seen.err;
  const nlohmann::json json = nlohmann::json::parse(seen.out);
  put(folder_ / "arm.toml",
      test::content_of(folder_ / "arm.toml") + "\n" + json.at("channels").get<std::string>());
  const CommandResult again = run({"look", path("a.csv")});
  EXPECT_THAT(again.out, HasSubstr("as the robot file's [channels] read it, at the joints:"));
  EXPECT_THAT(again.out, HasSubstr("nothing to add"));
  EXPECT_THAT(run({"look", "-"}, path("b.csv")).out, HasSubstr("nothing to add"));
  EXPECT_EQ(run({"compare", path("a.csv")}).exit_code, 0);
}

TEST_F(RecordingsOfVerbs, ComeThroughAPipeAsFromAFile) {
  const CommandResult file = run({"compare", path("a.csv"), "--json"});
  ASSERT_EQ(file.exit_code, 0) << file.err;
  const nlohmann::json expected = without_name(file.out);
  const std::string cat = "cat '" + path("a.csv") + "'";
  // As small pieces too, as a serial line gives them.
  const std::string pieces = "dd bs=7 status=none if='" + path("a.csv") + "'";
  for (const std::string& source : {cat, pieces}) {
    for (const char* name : {"-", "/dev/stdin"}) {
      const CommandResult result = piped(source, name);
      EXPECT_EQ(result.exit_code, 0) << result.err;
      EXPECT_EQ(without_name(result.out), expected) << source << " " << name;
    }
  }
  const CommandResult redirected = run({"compare", "-", "--json"}, path("a.csv"));
  EXPECT_EQ(redirected.exit_code, 0) << redirected.err;
  EXPECT_EQ(without_name(redirected.out), expected);
}

// What came through a pipe is gone: no word and no command may point at it.
TEST_F(RecordingsOfVerbs, ThatCameThroughAPipeAreNamedInWordsThatLast) {
  const auto hidden = [](const test::ArmInstant& at) { return Eigen::Vector2d(0, 4 * at.dq[1]); };
  put(folder_ / "v.csv",
      csv_text(test::record_arm({.duration_s = 20, .rate_hz = 200, .torque_noise = 0.05}, hidden)));
  const auto of_shell = [&](const std::string& line) {
    return test::run_command(
        "/bin/bash", {"-c", "cat '" + path("v.csv") + "' | '" + test::command_file() + "' " + line +
                                " --robot '" + path("arm.toml") + "'"});
  };
  const std::string fit = "add viscous_friction --joint 2 --log ";
  ASSERT_EQ(of_shell(fit + "- -o '" + path("a.toml") + "'").exit_code, 0);
  EXPECT_THAT(test::content_of(folder_ / "a.toml"),
              HasSubstr("Fitted to standard input by offnominal add."));
  const CommandResult piped =
      of_shell(fit + "<(cat '" + path("v.csv") + "') -o '" + path("b.toml") + "'");
  ASSERT_EQ(piped.exit_code, 0) << piped.err;
  EXPECT_THAT(test::content_of(folder_ / "b.toml"),
              HasSubstr("Fitted to a pipe by offnominal add."));
  put(folder_ / "c.toml",
      "[channels]\ntime = \"t\"\nposition = [{source = \"q1\"}, {source = "
      "\"q2\"}]\ntorque = [{source = \"tau1\"}, {source = \"tau2\"}]\n");
  const CommandResult told =
      of_shell("explain - --replays 0 --channels <(cat '" + path("c.toml") + "')");
  ASSERT_EQ(told.exit_code, 0) << told.err;
  EXPECT_THAT(told.out, HasSubstr("keep what came through a pipe in a file"));
  EXPECT_THAT(told.out, HasSubstr(" --log LOG --channels CHANNELS -o FILE"));
  EXPECT_THAT(told.out, Not(HasSubstr("/dev/fd")));
}

// What add says of the data, it says of them however it was told what to add.
TEST_F(RecordingsOfVerbs, HaveTheirFaultsInTheJsonOfBothKindsOfAdd) {
  put(folder_ / "long.csv",
      csv_text(test::record_arm({.duration_s = 20, .rate_hz = 200, .torque_noise = 0.05})));
  for (const Words& what : {Words{"viscous_friction", "--joint", "2"}, Words{"--all-found"}}) {
    Words words{"add", "--log", path("long.csv"), "-o", path("new.toml"), "--json"};
    words.insert(words.begin() + 1, what.begin(), what.end());
    const CommandResult result = run(words);
    EXPECT_THAT(result.exit_code, testing::AnyOf(0, 1)) << result.err;
    const nlohmann::json json = nlohmann::json::parse(result.out);
    EXPECT_TRUE(json.at("data_faults").is_array());
    if (what.size() > 1) continue;
    EXPECT_TRUE(json.at("data_hints").is_array());
    EXPECT_TRUE(json.at("advice").is_array());
  }
}

TEST_F(RecordingsOfVerbs, ThatNeverEndOrAreNoTextAreRefused) {
  put(folder_ / "binary", std::string("\x7f"
                                      "ELF\x02\x01\0\0\0",
                                      9) +
                              std::string(4096, '\0'));
  put(folder_ / "empty", "");
  expect_refusal(run({"compare", "/dev/zero"}), "/dev/zero: line 1: found bytes that are no text");
  expect_refusal(run({"compare", path("binary")}), "found bytes that are no text");
  expect_refusal(run({"compare", path("empty")}), "found an empty file");
  expect_refusal(run({"compare", folder_.path().string()}), "found a folder");
  expect_refusal(run({"compare", path("none.csv")}), "none.csv: found no such file");
  expect_refusal(run({"compare", "-"}), "standard input: found an empty file");
  expect_refusal(piped("tr '\\0' x < /dev/zero", "-"), "found a line longer than 1048576 bytes");
  expect_refusal(piped("yes 1", "-"), "line 1: found numbers in 1 columns");
  expect_refusal(piped("yes a,b", "-"), "columns: found a, b");
  // Before a copy of it fills the folder for temporary files.
  expect_refusal(piped("(printf MATLAB; cat /dev/zero)", "-"), "readable .mat file");
}

// What never ends and looks like a recording is refused where time no longer ascends.
TEST_F(RecordingsOfVerbs, AreReadAsFarAsTimeAscends) {
  const std::string header = "t,q1,q2,tau1,tau2";
  expect_refusal(piped("(echo " + header + "; yes 1,2,3,4,5)", "-"),
                 "line 3, time: found 1 s after 1 s");
  expect_refusal(piped("(echo " + header + "; yes nan,2,3,4,5)", "-"), "line 2, time: found nan s");
  put(folder_ / "channels.toml",
      "time = {source = \"t\", scale = 0.001}\nposition = [\"q1\", \"q2\"]\n"
      "torque = [\"tau1\", \"tau2\"]\n");
  expect_refusal(
      piped("(echo " + header + "; yes 1,2,3,4,5)", "- --channels '" + path("channels.toml") + "'"),
      "line 3, time: found 0.001 s after 0.001 s");
}

TEST_F(RecordingsOfVerbs, ThatNeedMoreMemoryThanThereIsAreRefused) {
#ifdef OFFNOMINAL_SANITIZE
  GTEST_SKIP() << "a sanitizer takes more address space than a limit could leave";
#endif
  const CommandResult result = test::run_command(
      "/bin/sh",
      {"-c", "ulimit -v 300000; (echo t,q1,q2,tau1,tau2; seq -f %.0f,1,2,3,4 1 20000000) | '" +
                 test::command_file() + "' compare - --robot '" + path("arm.toml") + "'"});
  expect_refusal(result, "standard input: found more than this machine has memory for");
}

TEST_F(RecordingsOfVerbs, ThroughAPipeNeedAFolderForTemporaryFilesOnlyAsMatFiles) {
  std::string mat(1000, '\0');
  mat.replace(0, 6, "MATLAB");
  mat[125] = 1;
  mat.replace(126, 2, "IM");
  put(folder_ / "a.mat", mat);
  const auto without_folder = [&](const std::string& name) {
    return test::run_command("/bin/sh", {"-c", "cat '" + path(name) + "' | TMPDIR=/nonexistent '" +
                                                   test::command_file() + "' compare - --robot '" +
                                                   path("arm.toml") + "'"});
  };
  expect_refusal(without_folder("a.mat"), "standard input: found that no copy of it can be kept (");
  EXPECT_THAT(without_folder("a.mat").err, HasSubstr("set TMPDIR to another"));
  EXPECT_EQ(without_folder("a.csv").exit_code, 0);
}

TEST_F(RecordingsOfVerbs, RobotAndChannelFilesThatNeverEndAreRefused) {
  const CommandResult robot =
      test::run_command(test::command_file(), {"compare", path("a.csv"), "--robot", "/dev/zero"});
  expect_refusal(robot, "/dev/zero: found more than 64 MiB");
  expect_refusal(run({"compare", path("a.csv"), "--channels", "/dev/zero"}), "more than 64 MiB");
}

TEST_F(RecordingsOfVerbs, AreNotHeldOutWhereTheyAreFitted) {
  std::filesystem::create_symlink("a.csv", folder_ / "link.csv");
  std::filesystem::copy_file(folder_ / "a.csv", folder_ / "copy.csv");
  Log later = test::record_arm({.duration_s = 6, .rate_hz = 200});
  later.t_s.array() += 1234.5;
  put(folder_ / "later.csv", csv_text(later));
  for (const char* same : {"a.csv", "link.csv", "copy.csv", "later.csv"}) {
    SCOPED_TRACE(same);
    const Words holdout{"--holdout", path(same)};
    const auto with = [&](Words words) {
      words.insert(words.end(), holdout.begin(), holdout.end());
      return run(words);
    };
    const std::string told = "--holdout: found " + path(same) + ", the same as " + path("a.csv");
    expect_refusal(with({"explain", path("a.csv")}), told);
    expect_refusal(with({"calibrate", path("a.csv"), "-o", path("new.toml")}), told);
    expect_refusal(with({"add", "viscous_friction", "--joint", "1", "--log", path("a.csv"), "-o",
                         path("new.toml")}),
                   told);
    expect_refusal(with({"add", "--all-found", "--log", path("a.csv"), "-o", path("new.toml")}),
                   told);
  }
  expect_refusal(run({"explain", path("a.csv"), path("copy.csv")}), "LOG: found ");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "new.toml"));
}

TEST_F(RecordingsOfVerbs, AndRobotsAreNamedInAdviceAsTheyHaveToBeTyped) {
  std::filesystem::create_directory(folder_ / "my arm");
  const std::string robot = path("my arm/it's.toml");
  const std::string log = path("my arm/$a.csv");
  write_robot_file(test::arm_description(), robot);
  // A joint that hardly moves: nothing can be said of it.
  put(log, csv_text(test::record_arm({.duration_s = 20, .rate_hz = 200, .amplitude = 1e-3})));
  const CommandResult result = test::run_command(
      test::command_file(),
      {"explain", log, "--robot", robot, "--replays", "0", "--report", path("page.html")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string quoted = "'" + path("my arm/it") + "'\\''s.toml'";
  EXPECT_THAT(result.out, HasSubstr("offnominal motion --robot " + quoted + " -o motion.csv"));
  EXPECT_THAT(result.out, Not(HasSubstr("ROBOT")));
  const std::string page = test::content_of(folder_ / "page.html");
  EXPECT_THAT(page, HasSubstr("offnominal explain '" + log + "' --robot"));
}

// One file per speed is the usual friction experiment.
TEST_F(RecordingsOfVerbs, GivenSeveralThenCompareAndAddTakeThemTogether) {
  const CommandResult compared = run({"compare", path("a.csv"), path("b.csv"), "--json"});
  ASSERT_EQ(compared.exit_code, 0) << compared.err;
  const auto json = nlohmann::json::parse(compared.out);
  EXPECT_EQ(json.at("logs"), (Words{path("a.csv"), path("b.csv")}));
  EXPECT_EQ(json.at("recordings").size(), 2U);

  const auto hidden = [](const test::ArmInstant& at) { return Eigen::Vector2d(0, 2 * at.dq[1]); };
  const Words speeds{"0.4", "0.7", "1.0"};
  for (const std::string& speed : speeds) {
    put(folder_ / (speed + ".csv"), csv_text(test::record_arm({.duration_s = 10,
                                                               .rate_hz = 200,
                                                               .torque_noise = 0.02,
                                                               .seed = 7,
                                                               .amplitude = std::stod(speed)},
                                                              hidden)));
  }
  const CommandResult added =
      run({"add", "viscous_friction", "--joint", "2", "--log", path("0.4.csv"), path("0.7.csv"),
           "--holdout", path("1.0.csv"), "-o", path("new.toml"), "--json"});
  ASSERT_EQ(added.exit_code, 0) << added.err;
  const auto answer = nlohmann::json::parse(added.out);
  EXPECT_NEAR(answer.at("parameters").at("coefficient").at("value").get<double>(), 2, 0.05);
  EXPECT_EQ(answer.at("holdout").at("kind"), "recording");
  EXPECT_EQ(answer.at("recordings").size(), 3U);
  EXPECT_TRUE(answer.at("recordings")[2].at("held_out"));
  EXPECT_THAT(test::content_of(folder_ / "new.toml"), HasSubstr("Fitted to 0.4.csv, 0.7.csv"));
}

TEST_F(RecordingsOfVerbs, GivenAPayloadThenItIsOfThatRecordingAndSaid) {
  test::ArmRecording loaded{.duration_s = 6, .rate_hz = 200};
  loaded.arm.mass2_kg += 0.7;
  put(folder_ / "loaded.csv", csv_text(test::record_arm(loaded)));
  const RobotDescription arm = test::arm_description();
  const auto& centre = arm.joints[1].joint.centre_of_mass_m;
  const std::string place =
      shortest(centre[0]) + "," + shortest(centre[1]) + "," + shortest(centre[2]);
  const CommandResult result = run({"compare", path("a.csv"), path("loaded.csv"), "--payload",
                                    "loaded.csv=0.7@" + place, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_LT(json.at("joints")[1].at("relative_error_percent").get<double>(), 1);
  EXPECT_EQ(json.at("recordings")[1].at("payload").at("mass_kg"), 0.7);
  EXPECT_THAT(json.at("recordings")[1].at("remarks").dump(), HasSubstr("with a payload of 0.7 kg"));
  expect_refusal(run({"compare", path("a.csv"), "--payload", "b.csv=0.7@0,0,0"}),
                 "--payload: found a payload of b.csv; allowed: one of the recordings");
  expect_refusal(run({"replay", path("a.csv"), "--payload", "a.csv=0.7"}), "LOG=KG@X,Y,Z");
  expect_refusal(run({"compare", path("a.csv"), "--payload", "5@0,0"}),
                 "to mend: write the recording and = before the mass, and write three numbers "
                 "behind @, its place in the last link's frame");
  expect_refusal(run({"compare", path("a.csv"), "--payload", "a.csv=-5@0,0,0"}),
                 "to mend: write a mass of 0 to ");
}

TEST_F(RecordingsOfVerbs, GivenOneTwiceThenCompareRefusesIt) {
  expect_refusal(run({"compare", path("a.csv"), path("a.csv")}), "recordings that differ");
  expect_refusal(run({"compare", path("a.csv"), (folder_ / "." / "a.csv").string()}),
                 "recordings that differ");
}

TEST_F(RecordingsOfVerbs, GivenOneThatDoesNotFitThenItIsNamed) {
  put(folder_ / "one.csv", "t,q1,tau1\n0,0,0\n0.01,0,0\n");
  expect_refusal(run({"compare", path("a.csv"), path("one.csv")}),
                 "one.csv: columns: found q1 only");
}

TEST_F(RecordingsOfVerbs, GivenSeveralThenThePageOfExplainShowsEachAndTheHeldOutToo) {
  for (const char* name : {"u.csv", "v.csv", "w.csv"}) {
    put(folder_ / name, csv_text(test::record_arm({.duration_s = 12,
                                                   .rate_hz = 200,
                                                   .torque_noise = 0.05,
                                                   .amplitude = 0.5 + 0.1 * (name[0] - 't')})));
  }
  const CommandResult result =
      run({"explain", path("u.csv"), path("v.csv"), "--holdout", path("w.csv"), "--replays", "0",
           "--report", path("page.html")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string page = test::content_of(folder_ / "page.html");
  for (const std::string& name : {path("u.csv"), path("v.csv"), path("w.csv") + " (held out)"}) {
    EXPECT_THAT(page, HasSubstr("\"recording\":\"" + name + "\""));
  }
}

// Which of them are of before and which of after is said of all, or there is no question.
TEST_F(RecordingsOfVerbs, BeforeAndAfterComeTogetherAndInsteadOfRecordings) {
  expect_refusal(run({"explain"}),
                 "explain: LOG: found none; allowed: one recording or more, or "
                 "--before and --after");
  expect_refusal(run({"explain", "--before", path("a.csv")}), "--before requires --after");
  expect_refusal(run({"explain", "--after", path("a.csv")}), "--after requires --before");
  expect_refusal(
      run({"explain", path("a.csv"), "--before", path("a.csv"), "--after", path("b.csv")}),
      "excludes");
  expect_refusal(run({"explain", "--before", path("a.csv"), "--after", path("a.csv")}),
                 "--before and --after");
  expect_refusal(run({"explain", path("a.csv"), "--since", "100"}), "--since: found 100 s");
  const CommandResult told = run(
      {"explain", "--before", path("a.csv"), "--after", path("b.csv"), "--replays", "0", "--json"});
  ASSERT_EQ(told.exit_code, 0) << told.err;
  const nlohmann::json json = nlohmann::json::parse(told.out);
  EXPECT_EQ(json.at("after"), nlohmann::json({path("b.csv")}));
  EXPECT_EQ(json.at("logs").size(), 2U);
}

}  // namespace
}  // namespace offnominal::desk
