#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <offnominal/version.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "desk/sil/serial_robot.hpp"
#include "desk/support/run_command.hpp"
#include "desk/support/verbs.hpp"
#include "explain/explain.hpp"
#include "log/log_format.hpp"
#include "support/places.hpp"
#include "support/repetitions.hpp"

// The built command as a user meets it.

namespace offnominal::desk {
namespace {

using test::CommandResult;
using test::verbs;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

CommandResult offnominal(const std::vector<std::string>& arguments) {
  return test::run_command(test::command_file(), arguments);
}

void expect_one_line_refusal(const CommandResult& result) {
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_EQ(result.err.find_last_of('\n'), result.err.size() - 1) << result.err;
}

TEST(Command, SaysItsVersion) {
  const CommandResult result = offnominal({"--version"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out, "offnominal " + std::to_string(kVersionMajor) + "." +
                            std::to_string(kVersionMinor) + "." + std::to_string(kVersionPatch) +
                            "\n");
  EXPECT_EQ(result.err, "");
}

TEST(Command, HasAVerbForEveryVerbFile) {
  std::vector<std::string> expected;
  const std::filesystem::path folder = test::source_dir() / "apps" / "command";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::string name = entry.path().filename().string();
    if (!name.starts_with("verb_") || entry.path().extension() != ".cpp") continue;
    name = name.substr(5, name.size() - 9);
    std::replace(name.begin(), name.end(), '_', '-');
    expected.push_back(name);
  }
  EXPECT_FALSE(expected.empty());
  EXPECT_THAT(verbs(), testing::UnorderedElementsAreArray(expected));
}

TEST(Command, HelpsWithEveryVerb) {
  for (const std::string& verb : verbs()) {
    const CommandResult result = offnominal({verb, "--help"});
    EXPECT_EQ(result.exit_code, 0) << verb;
    EXPECT_THAT(result.out, HasSubstr("offnominal " + verb)) << verb;
    EXPECT_THAT(result.out, HasSubstr("--json")) << verb;
    EXPECT_EQ(result.err, "") << verb;
  }
}

TEST(Command, NamesEveryFormatOfARecordingWhereItAsksForOne) {
  int asked = 0;
  for (const std::string& verb : verbs()) {
    std::string help = offnominal({verb, "--help"}).out;
    if (help.find("\n  LOG ") == std::string::npos && verb != "add") continue;
    ++asked;
    EXPECT_THAT(help, HasSubstr(log_format_names())) << verb;
  }
  EXPECT_GE(asked, 5);
}

TEST(Command, IsInTheReadmeWithEveryVerb) {
  const std::string readme = test::content_of(test::source_dir() / "README.md");
  for (const std::string& verb : verbs()) {
    EXPECT_THAT(readme, testing::ContainsRegex("\n[|] `" + verb + "[` ]")) << verb;
  }
}

TEST(Command, NamesEveryVerdictInHelpAndGuide) {
  const std::string help = offnominal({"explain", "--help"}).out;
  const std::string guide = test::content_of(test::source_dir() / "docs" / "explain.md");
  const std::vector<std::string> names = verdict_names();
  EXPECT_GE(names.size(), 8U);
  for (const std::string& name : names) {
    EXPECT_THAT(help, HasSubstr(name));
    EXPECT_THAT(guide, HasSubstr("`" + name + "`"));
  }
}

TEST(Command, ListsItsVerbsWhereNoneOrAnUnknownOneIsGiven) {
  const CommandResult none = offnominal({});
  expect_one_line_refusal(none);
  EXPECT_THAT(none.err, StartsWith("offnominal: found no verb; allowed: "));
  const CommandResult unknown = offnominal({"compar"});
  expect_one_line_refusal(unknown);
  EXPECT_THAT(unknown.err, StartsWith("offnominal: found unknown verb `compar`; allowed: "));
  for (const std::string& verb : verbs()) {
    EXPECT_THAT(none.err, HasSubstr(verb));
    EXPECT_THAT(unknown.err, HasSubstr(verb));
  }
}

TEST(Command, SuggestsTheVerbThatWasMeant) {
  for (const std::string& verb : verbs()) {
    if (verb.size() < 4) continue;
    EXPECT_THAT(offnominal({verb.substr(0, verb.size() - 1)}).err,
                HasSubstr("write `" + verb + "`"));
  }
}

TEST(Command, RefusesAnUnknownOptionOfEveryVerbInOneLine) {
  for (const std::string& verb : verbs()) {
    const CommandResult result = offnominal({verb, "--no-such-option"});
    SCOPED_TRACE(verb);
    expect_one_line_refusal(result);
    EXPECT_THAT(result.err, StartsWith("offnominal " + verb + ": "));
    EXPECT_THAT(result.err, HasSubstr("run `offnominal " + verb + " --help`"));
  }
}

// The long options of a verb, as its help lists them.
std::vector<std::string> options_of(const std::string& verb) {
  std::istringstream help(offnominal({verb, "--help"}).out);
  std::vector<std::string> names;
  for (std::string line; std::getline(help, line);) {
    if (!line.starts_with("  -")) continue;
    const std::size_t begin = line.find("--");
    if (begin > 6) continue;
    names.push_back(line.substr(begin, line.find_first_of(" ,=", begin) - begin));
  }
  return names;
}

TEST(Command, SuggestsTheOptionThatWasMeant) {
  EXPECT_THAT(offnominal({"compare", "a.csv", "--robot", "r.toml", "--cutof", "50"}).err,
              HasSubstr("to mend: write --cutoff, or run `offnominal compare --help`"));
  for (const std::string& verb : verbs()) {
    const auto names = options_of(verb);
    EXPECT_GE(names.size(), 4U) << verb;
    for (const std::string& name : test::every_nth(names, 20)) {
      if (name.size() < 6) continue;
      // One letter too many, as a finger slips.
      const CommandResult result = offnominal({verb, name + "x"});
      expect_one_line_refusal(result);
      EXPECT_THAT(result.err, HasSubstr("write " + name + ",")) << verb;
    }
  }
}

TEST(Command, RefusesNumbersThatNoRobotHas) {
  const test::TemporaryFolder folder;
  test::put(folder / "log.csv", "t,q1,tau1\n0,0,0\n");
  const std::string robot = test::content_of(test::source_dir() / "robots" / "bam_xl330.toml");
  struct Wrong {
    std::string key, told;
  };
  for (const Wrong& wrong :
       {Wrong{"mass_kg = ", "joint[1].link.mass_kg: found 1e+300; allowed: at most 1e+07 kg"},
        Wrong{"centre_of_mass_m = [", "joint[1].link.centre_of_mass_m[1]: found 1e+300"},
        Wrong{"gravity_m_s2 = [", "gravity_m_s2[1]: found 1e+300"},
        Wrong{"inertia = ", "effect[1].inertia: found 1e+300"}}) {
    std::string text = robot;
    const auto at = text.find(wrong.key);
    ASSERT_NE(at, std::string::npos) << wrong.key;
    const auto begin = at + wrong.key.size();
    text.replace(begin, text.find_first_of(",] #\n", begin) - begin, "1e300");
    test::put(folder / "r.toml", text);
    const CommandResult result = offnominal(
        {"compare", (folder / "log.csv").string(), "--robot", (folder / "r.toml").string()});
    expect_one_line_refusal(result);
    EXPECT_THAT(result.err, HasSubstr("r.toml: line "));
    EXPECT_THAT(result.err, HasSubstr(wrong.told));
  }
}

TEST(Command, NamesTheVerbAndTheTableThatAreMeant) {
  const CommandResult run = offnominal({"sil", "--duration", "1e9"});
  expect_one_line_refusal(run);
  EXPECT_THAT(run.err, StartsWith("offnominal sil: --duration: found 1e+09 s"));
  const test::TemporaryFolder folder;
  std::string text = test::content_of(test::source_dir() / "robots" / "two_link.toml");
  text.resize(text.find("[uncertainty_bound]"));
  test::put(folder / "r.toml", text);
  const std::string robot = (folder / "r.toml").string();
  test::put(folder / "log.csv", "t,q1,q2,tau1,tau2\n0,0,0,0,0\n0.001,0,0,0,0\n0.002,0,0,0,0\n");
  const std::string log = (folder / "log.csv").string();
  const std::vector<std::vector<std::string>> calls{
      {"sil", "--fault", "none", "--robot", robot, "--real-time"},
      {"paper", "--fault", "none", "--robot", robot},
      {"paper", "--sweep", "--against", robot},
      {"replay", log, "--robot", robot},
      {"codegen", robot, "-o", (folder / "r.hpp").string()}};
  for (const std::vector<std::string>& call : calls) {
    SCOPED_TRACE(call.front());
    const CommandResult result = offnominal(call);
    expect_one_line_refusal(result);
    EXPECT_THAT(result.err, StartsWith(robot + ": uncertainty_bound: found nothing"));
    EXPECT_THAT(result.err, HasSubstr("a table [uncertainty_bound]"));
  }
}

// GIVEN a robot file without a bound THEN a run in lock-step is the recording to find one on, and
// says that nothing was judged.
TEST(Command, RunsARobotWithoutABoundAndJudgesNothing) {
  const test::TemporaryFolder folder;
  std::string text = test::content_of(test::source_dir() / "robots" / "two_link.toml");
  text.resize(text.find("[uncertainty_bound]"));
  test::put(folder / "r.toml", text);
  const std::string robot = (folder / "r.toml").string();
  const CommandResult result =
      offnominal({"sil", "--fault", "none", "--duration", "1", "--robot", robot});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.err, StartsWith(robot + ": no [uncertainty_bound]"));
  EXPECT_THAT(result.out, HasSubstr("Nothing was judged"));
}

// GIVEN an arm that its controller cannot hold WHEN it runs without a fault THEN that is no run in
// which nothing is wrong.
TEST(Command, FailsWhereSilEndsInASafeStateThatNobodyAskedFor) {
  const test::TemporaryFolder folder;
  std::string text = test::serial_robot_text(2);
  text += "[arming]\ntorque_rate = [50.0, 50.0]\n";
  test::put(folder / "r.toml", text);
  const std::vector<std::string> call{"sil", "--duration", "1", "--robot",
                                      (folder / "r.toml").string()};
  const CommandResult result = offnominal(call);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.out, HasSubstr("The arm was not held: joint "));
  EXPECT_THAT(result.out, Not(HasSubstr("Nothing is wrong")));
}

TEST(Command, SaysWhichFileOfSilIsOfAnotherArm) {
  const test::TemporaryFolder folder;
  const std::string two = (folder / "two.toml").string();
  const std::string three = (folder / "three.toml").string();
  test::put(folder / "two.toml", test::serial_robot_text(2));
  test::put(folder / "three.toml", test::serial_robot_text(3));
  const auto told = [&](const std::vector<std::string>& more, const std::string& start) {
    std::vector<std::string> call{"sil", "--robot", two};
    call.insert(call.end(), more.begin(), more.end());
    const CommandResult result = offnominal(call);
    expect_one_line_refusal(result);
    EXPECT_THAT(result.err, AllOf(StartsWith(start), HasSubstr("to mend: ")));
  };
  told({"--plant", three}, three + ": [[joint]]: found robot serial with 3 joint(s); allowed: ");
  told({"--fault", "nonlinear"}, "offnominal sil: --fault: found nonlinear, for robot serial");
}

TEST(Command, NamesTheVerbWhereARoomKnowsTheOptionOnly) {
  const test::TemporaryFolder folder;
  std::string log = "t,q1,q2,tau1,tau2\n";
  for (int i = 0; i < 1000; ++i) log += std::to_string(i) + "e-2,0.1,0.1,0,0\n";
  test::put(folder / "log.csv", log);
  const std::string file = (folder / "log.csv").string();
  const std::string robot = (test::source_dir() / "robots" / "two_link.toml").string();
  const std::string output = (folder / "new.toml").string();
  const auto told = [&](const std::vector<std::string>& call, const std::string& start) {
    const CommandResult result = offnominal(call);
    expect_one_line_refusal(result);
    EXPECT_THAT(result.err, StartsWith(start));
  };
  told({"compare", file, "--robot", robot, "--decimate", "0"},
       "offnominal compare: --decimate: found 0");
  told({"compare", file, "--robot", robot, "--cutoff", "1e6"},
       "offnominal compare: --cutoff: found 1e+06 Hz");
  told({"add", "viscous_friction", "--joint", "3", "--robot", robot, "--log", file, "-o", output},
       "offnominal add: --joint: found 3");
}

TEST(Command, RefusesAnUnknownOptionOfItsOwn) {
  const CommandResult result = offnominal({"--no-such-option"});
  expect_one_line_refusal(result);
  EXPECT_THAT(result.err, HasSubstr("--no-such-option"));
}

// What Studio shows is one of five, and each has options that the others have no use for.
TEST(Command, RefusesStudioOfTwoThingsAtOnce) {
  const std::vector<std::vector<std::string>> wrong = {
      {"a.csv"},  // without a robot file
      {"--sil"},
      {"--bus", "can0", "--sil", "--robot", "r.toml"},
      {"--holdout", "a.csv"},
      {"--channels", "c.toml"},
      {"--period", "0.001"},
      {"--payload", "a.csv=1@0,0,0"},
      {"--campaign", "a.sqlite", "--robot", "r.toml"},
      {"--campaign", "a.sqlite", "--bus", "can0"},
      {"--campaign", "no_such.sqlite"}};
  for (std::vector<std::string> words : wrong) {
    words.insert(words.begin(), {"studio", "--no-open"});
    const CommandResult result = offnominal(words);
    expect_one_line_refusal(result);
  }
}

// A plant is of a run that is simulated, and takes faults while it runs.
TEST(Command, RefusesStudioAPlantThatItCannotHave) {
  const std::string robot = (test::source_dir() / "robots" / "two_link.toml").string();
  const auto told = [](std::vector<std::string> words, const std::string& expected) {
    words.insert(words.begin(), {"studio", "--no-open"});
    const CommandResult result = offnominal(words);
    expect_one_line_refusal(result);
    EXPECT_THAT(result.err, HasSubstr(expected));
  };
  told({"--bus", "can0", "--robot", robot, "--plant", robot},
       "studio: --plant: found without --sil");
  told({"a.csv", "--robot", robot, "--motion", "sway"}, "studio: --motion: found without --sil");
  told({"--sil", "--robot", robot, "--plant", "paper"}, "studio: --plant: found paper");
}

TEST(Command, FailsWhereItsOutputCannotBeWritten) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full here";
  const CommandResult result = test::run_command(test::command_file(), {"--help"}, "/dev/full");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, StartsWith("standard output: found that it cannot be written"));
}

TEST(Command, RefusesAWrongRobotFileWithItsLine) {
  const auto names = verbs();
  if (std::find(names.begin(), names.end(), "compare") == names.end()) {
    GTEST_SKIP() << "this build has no verb compare";
  }
  const test::TemporaryFolder folder;
  test::put(folder / "log.csv", "t,q1,tau1\n0,0,0\n");
  test::put(folder / "r.toml", "format = 1\nname = \"r\"\nmass = 3\n");
  const CommandResult result = offnominal(
      {"compare", (folder / "log.csv").string(), "--robot", (folder / "r.toml").string()});
  expect_one_line_refusal(result);
  EXPECT_THAT(result.err, StartsWith((folder / "r.toml").string() +
                                     ": line 3, mass: found an unknown key; allowed: format"));
}

}  // namespace
}  // namespace offnominal::desk
