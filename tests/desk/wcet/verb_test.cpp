#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "desk/support/run_command.hpp"
#include "support/places.hpp"

namespace offnominal::desk {
namespace {

using testing::HasSubstr;

test::CommandResult wcet(std::vector<std::string> arguments) {
  const std::vector<std::string> quick{"--ticks", "2000", "--cold-ticks", "2", "--search", "20"};
  arguments.insert(arguments.begin(), quick.begin(), quick.end());
  return test::run_command(test::wcet_file(), std::move(arguments));
}

TEST(WcetProgram, TellsMeasuredFromExtrapolated) {
  const auto result = wcet({});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("\nMeasured: the longest of 2000 ticks"));
  EXPECT_THAT(result.out, HasSubstr("\nExtrapolated, not measured: "));
  EXPECT_THAT(result.out, HasSubstr("kernel preemption model"));
  EXPECT_THAT(result.out, HasSubstr("#"));
}

TEST(WcetProgram, GivesAHistogramThatAddsUp) {
  const auto result = wcet({"--json", "--scalar", "double"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["scalar"], "double");
  const auto& warm = json["worst_warm"];
  std::int64_t sum = 0;
  for (const auto& bin : warm["bins"]) {
    sum += bin[2].get<std::int64_t>();
    EXPECT_LE(bin[1].get<std::int64_t>() - bin[0].get<std::int64_t>(), 1000);
  }
  EXPECT_EQ(sum, 2000);
  EXPECT_LE(warm["min_ns"], warm["p50_ns"]);
  EXPECT_LE(warm["p50_ns"], warm["p99.9999_ns"]);
  EXPECT_LE(warm["p99.9999_ns"], warm["max_ns"]);
  EXPECT_EQ(json["scenarios"].size(), 8U);
  EXPECT_EQ(json["phases"].size(), 6U);
}

TEST(WcetProgram, SaysWhatToInstallForTheComparison) {
  const test::TemporaryFolder empty;
  const char* path = std::getenv("PATH");
  const std::string before = path == nullptr ? "" : path;
  ASSERT_EQ(::setenv("PATH", empty.path().c_str(), 1), 0);
  const auto result = wcet({"--compare-cyclictest", "--cyclic-ticks", "2"});
  ASSERT_EQ(::setenv("PATH", before.c_str(), 1), 0);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err,
              HasSubstr("no cyclictest on this machine; to mend: install the package rt-tests"));
  EXPECT_EQ(result.out, "");
}

// With the program itself: what it writes is what is read.
TEST(WcetProgram, ComparesWithCyclictest) {
  const auto result = wcet({"--compare-cyclictest", "--cyclic-ticks", "20", "--json"});
  if (result.exit_code != 0 && result.err.find("no cyclictest") != std::string::npos) {
    GTEST_SKIP() << "cyclictest is not installed (package rt-tests)";
  }
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto comparison = nlohmann::json::parse(result.out)["comparison"];
  EXPECT_EQ(comparison["interval_us"], 1000);
  EXPECT_EQ(comparison["cyclictest"]["cycles"], 20);
  EXPECT_EQ(comparison["tick_response"]["ticks"], 20);
  EXPECT_GT(comparison["cyclictest"]["max_us"], 0);
}

TEST(WcetProgram, RefusesNumbersThatMakeNoSense) {
  EXPECT_EQ(test::run_command(test::wcet_file(), {"--ticks", "0"}).exit_code, 2);
  EXPECT_EQ(test::run_command(test::wcet_file(), {"--ticks", "100000001"}).exit_code, 2);
  const auto cpu = wcet({"--cpu", "4000"});
  EXPECT_EQ(cpu.exit_code, 2);
  EXPECT_THAT(cpu.err, HasSubstr("--cpu: found 4000"));
  const auto period = wcet({"--period", "nan"});
  EXPECT_EQ(period.exit_code, 2);
  EXPECT_THAT(period.err, HasSubstr("offnominal-wcet: --period: found nan; allowed: a number"));
}

TEST(WcetProgram, WantsABoundAndReplacesNoFile) {
  const test::TemporaryFolder folder;
  std::string text = test::content_of(test::source_dir() / "robots" / "two_link.toml");
  text.resize(text.find("[uncertainty_bound]"));
  test::put(folder / "r.toml", text);
  const auto unbounded = wcet({"--robot", (folder / "r.toml").string()});
  EXPECT_EQ(unbounded.exit_code, 2);
  EXPECT_THAT(unbounded.err, HasSubstr("a table [uncertainty_bound]"));
  const auto over = wcet({"--report", (folder / "r.toml").string()});
  EXPECT_EQ(over.exit_code, 2);
  EXPECT_THAT(over.err, HasSubstr("which is there already"));
  EXPECT_EQ(test::content_of(folder / "r.toml"), text);
}

// The page says how it was made, with the program's own name.
TEST(WcetProgram, WritesAPageAndReplacesItByAnother) {
  const test::TemporaryFolder folder;
  const std::string page = (folder / "wcet.html").string();
  for (int i = 0; i < 2; ++i) ASSERT_EQ(wcet({"--report", page}).exit_code, 0);
  EXPECT_THAT(test::content_of(page), HasSubstr("offnominal-wcet --ticks 2000"));
}

}  // namespace
}  // namespace offnominal::desk
