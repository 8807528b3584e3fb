#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "desk/support/run_command.hpp"
#include "desk/support/verbs.hpp"

// The one rule for every file that a verb writes, as a user meets it.

namespace offnominal::desk {
namespace {

using test::CommandResult;
using test::content_of;
using test::put;
using testing::HasSubstr;
using Words = std::vector<std::string>;

class OutputFile : public testing::Test {
 protected:
  std::string path(const std::string& name) { return (folder_ / name).string(); }

  Words with(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  // A call of every verb up to its outputs, and what its options write. What it reads is not there:
  // an output is refused before anything is read.
  struct Call {
    Words words;
    Words outputs;
  };
  std::map<std::string, Call> calls() {
    const Words robot{"--robot", path("r.toml")};
    return {
        {"add",
         {with({"add", "viscous_friction", "--joint", "1", "--log", path("a.csv")}, robot),
          {"-o", "--report"}}},
        {"calibrate", {with({"calibrate", path("a.csv")}, robot), {"-o", "--report"}}},
        // Results are gone on with, and kept apart by what is in them (desk/campaign).
        {"campaign", {{"campaign", path("r.toml"), "-o", path("results")}, {"--report"}}},
        {"campaign merge", {{"campaign", "merge", path("r.toml")}, {"-o", "--report"}}},
        {"campaign record",
         {{"campaign", "record", path("r.toml"), "--run", "0"}, {"-o", "--model"}}},
        {"campaign show", {{"campaign", "show", path("r.toml")}, {"--report"}}},
        {"codegen", {{"codegen", path("r.toml")}, {"-o"}}},
        {"compare", {with({"compare", path("a.csv")}, robot), {"--report"}}},
        {"explain", {with({"explain", path("a.csv")}, robot), {"--report"}}},
        {"export-mjcf", {{"export-mjcf", path("r.toml")}, {"-o"}}},
        {"export-urdf", {{"export-urdf", path("r.toml")}, {"-o"}}},
        {"identify", {with({"identify", path("a.csv")}, robot), {"-o", "--report"}}},
        {"import-urdf", {{"import-urdf", path("r.toml")}, {"-o"}}},
        {"look", {{"look", path("r.toml")}, {"--report"}}},
        {"motion", {with({"motion"}, robot), {"-o", "--report"}}},
        {"new", {{"new", "--dh", path("r.toml")}, {"-o"}}},
        {"paper", {with({"paper", "--fault", "none"}, robot), {"--log", "--report"}}},
        {"replay", {with({"replay", path("a.csv")}, robot), {"--report"}}},
        {"sil", {with({"sil"}, robot), {"--log", "--candump", "--report"}}},
        {"studio", {with({"studio", path("a.csv"), "--no-open"}, robot), {"-o"}}},
        {"tune", {with({"tune", path("a.csv")}, robot), {"-o"}}},
    };
  }

  // The call with `option` naming `file`, and a new file for whatever else the verb must write.
  Words writing(const Call& call, const std::string& option, const std::string& file) {
    Words words = with(call.words, {option, file});
    if (option != "-o" && call.outputs.front() == "-o") words = with(words, {"-o", path("new")});
    return words;
  }

  static CommandResult run_words(const Words& words) {
    return test::run_command(test::command_file(), words);
  }

  void expect_refusal(const Words& words, const std::string& told) {
    const CommandResult result = run_words(words);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_THAT(result.err, HasSubstr(told));
  }

  test::TemporaryFolder folder_;
};

TEST_F(OutputFile, OfEveryVerbReplacesNoFileThatIsThere) {
  const auto all = calls();
  for (const std::string& verb : test::verbs()) ASSERT_TRUE(all.contains(verb)) << verb;
  put(folder_ / "script.sh", "somebody's work");
  for (const auto& [verb, call] : all) {
    for (const std::string& option : call.outputs) {
      SCOPED_TRACE(verb + " " + option);
      expect_refusal(writing(call, option, path("script.sh")),
                     option + ": found " + path("script.sh") + ", which is there already");
      EXPECT_EQ(content_of(folder_ / "script.sh"), "somebody's work");
    }
  }
}

TEST_F(OutputFile, OfEveryVerbIsNeverAnInput) {
  const std::set<std::string> kMayWriteItsRobot = {"add", "calibrate", "identify", "studio",
                                                   "tune"};
  put(folder_ / "r.toml", "input");
  std::filesystem::create_symlink("r.toml", folder_ / "link");
  for (const auto& [verb, call] : calls()) {
    for (const std::string& option : call.outputs) {
      SCOPED_TRACE(verb + " " + option);
      // `-o` of those may write the robot file that they read.
      if (option == "-o" && kMayWriteItsRobot.contains(verb)) continue;
      for (const char* name : {"r.toml", "link"}) {
        expect_refusal(with(writing(call, option, path(name)), {"--force"}), "which is that of ");
      }
      EXPECT_EQ(content_of(folder_ / "r.toml"), "input");
    }
  }
}

TEST_F(OutputFile, IsNoPartOfARecordingOfSeveralFiles) {
  put(folder_ / "positions.csv", "measured");
  put(folder_ / "currents.csv", "measured");
  const std::string both = path("positions.csv") + "+" + path("currents.csv");
  for (const char* name : {"positions.csv", "currents.csv"}) {
    expect_refusal({"compare", both, "--robot", path("r.toml"), "--report", path(name), "--force"},
                   "which is that of ");
    EXPECT_EQ(content_of(folder_ / name), "measured");
  }
}

TEST_F(OutputFile, OfEveryVerbIsRefusedBeforeTheWorkWhereItCannotBeWritten) {
  std::filesystem::create_directory(folder_ / "closed");
  std::filesystem::permissions(folder_ / "closed", std::filesystem::perms::owner_read);
  for (const auto& [verb, call] : calls()) {
    for (const std::string& option : call.outputs) {
      SCOPED_TRACE(verb + " " + option);
      const auto told_of = [&, &call = call](const std::string& file, const std::string& told) {
        expect_refusal(with(writing(call, option, file), {"--force"}), told);
      };
      told_of(path("no/such/folder"), "No such file or directory");
      told_of(folder_.path().string(), "a folder");
      told_of("/dev/full", "not a regular file");
      told_of("-", "a stream");
      if (::geteuid() != 0) told_of(path("closed/file"), "Permission denied");
    }
  }
}

TEST_F(OutputFile, APageIsWrittenAgainAndAScriptIsNot) {
  const Words run{"paper", "--fault", "none", "--duration", "1", "--report", path("page.html")};
  ASSERT_EQ(run_words(run).exit_code, 0);
  const std::string page = content_of(folder_ / "page.html");
  ASSERT_EQ(run_words(with(run, {"--start", "1"})).exit_code, 0);
  EXPECT_NE(content_of(folder_ / "page.html"), page);
  for (const std::string& work : {std::string("#!/bin/sh\n"), std::string(),
                                  "#!/bin/sh\ncat <<'EOF' > page.html\n" + page + "EOF\n",
                                  std::string("<!doctype html>\n<html></html>\n")}) {
    put(folder_ / "page.html", work);
    expect_refusal(run, "or a page of offnominal; to mend: choose another name, or add --force");
    EXPECT_EQ(content_of(folder_ / "page.html"), work);
  }
  EXPECT_EQ(run_words(with(run, {"--force"})).exit_code, 0);
  EXPECT_THAT(content_of(folder_ / "page.html"), testing::StartsWith("<!doctype html>"));
}

TEST_F(OutputFile, TwoOutputsOfOneCallAreTwoFiles) {
  expect_refusal({"sil", "--log", path("x"), "--candump", path("x")}, "which is that of ");
  expect_refusal({"paper", "--fault", "none", "--log", path("x"), "--report", path("./x")},
                 "which is that of ");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x"));
}

TEST_F(OutputFile, TwoOutputsOfOneCallAreTwoFilesByWhateverNames) {
  std::filesystem::create_directory(folder_ / "sub");
  std::filesystem::create_directory_symlink("sub", folder_ / "link");
  const std::string here = "cd '" + folder_.path().string() + "' && '" + test::command_file() +
                           "' sil --duration 1 --force --log ";
  for (const auto& [log, candump] :
       std::map<std::string, std::string>{{"x", "./x"},
                                          {"./y", "y"},
                                          {"sub/../z", "z"},
                                          {"u", "\"$PWD/u\""},
                                          {"link/v", "sub/v"},
                                          {"sub/w", "./link/../link/w"}}) {
    SCOPED_TRACE(log + " " + candump);
    const CommandResult result =
        test::run_command("/bin/sh", {"-c", here + log + " --candump " + candump});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("which is that of --"));
  }
  const CommandResult apart = test::run_command("/bin/sh", {"-c", here + "x --candump sub/x"});
  EXPECT_EQ(apart.exit_code, 0) << apart.err;
  EXPECT_NE(content_of(folder_ / "x"), content_of(folder_ / "sub/x"));
}

}  // namespace
}  // namespace offnominal::desk
