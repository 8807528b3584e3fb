#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <offnominal/version.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "support/places.hpp"
#include "tools/support/run_command.hpp"

// The built command as a user meets it.

namespace offnominal::tools {
namespace {

using test::CommandResult;
using testing::HasSubstr;
using testing::StartsWith;

CommandResult offnominal(const std::vector<std::string>& arguments) {
  return test::run_command(test::command_file(), arguments);
}

// The verbs as the help lists them, below its heading.
std::vector<std::string> verbs() {
  std::istringstream help(offnominal({"--help"}).out);
  std::vector<std::string> names;
  bool listed = false;
  for (std::string line; std::getline(help, line);) {
    if (listed && line.starts_with("  ") && line.size() > 2 && line[2] != ' ') {
      names.push_back(line.substr(2, line.find(' ', 2) - 2));
    }
    listed = listed || line.starts_with("Subcommands:");
  }
  return names;
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
  const std::filesystem::path folder = test::source_dir() / "tools" / "command";
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

TEST(Command, RefusesAnUnknownOptionOfItsOwn) {
  const CommandResult result = offnominal({"--no-such-option"});
  expect_one_line_refusal(result);
  EXPECT_THAT(result.err, HasSubstr("--no-such-option"));
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
}  // namespace offnominal::tools
