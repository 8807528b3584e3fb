// A benchmark's results behind the server: what its figures and cases say, and a case that is
// opened.
#include "studio/benchmark_view.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "common/refused.hpp"
#include "common/sqlite.hpp"
#include "desk/studio/benchmark_results.hpp"
#include "desk/support/temporary_folder.hpp"

namespace {

using nlohmann::json;
using nlohmann::ordered_json;
using offnominal::test::benchmark_results;
using offnominal::test::put;
using offnominal::test::TemporaryFolder;
using namespace offnominal::desk;
using namespace offnominal::desk::benchmark;
using namespace offnominal::desk::studio;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;

class BenchmarkResults : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  [[nodiscard]] std::string file() const { return (folder_ / "bench.sqlite").string(); }
  void SetUp() override { write_benchmark(file(), benchmark_results(), Existing::kRefuse); }

  [[nodiscard]] json table(const ResultsFilter& filter, const std::string& caption) const {
    const json figures = BenchmarkView(file()).figures(filter);
    for (const json& section : figures.at("sections")) {
      for (const json& block : section.at("blocks")) {
        if (block.value("caption", "") == caption) return block;
      }
    }
    return {};
  }
};

TEST_F(BenchmarkResults, AreReadAsTheyWereWritten) {
  EXPECT_EQ(read_benchmark(file()), benchmark_results());
  EXPECT_THROW(write_benchmark(file(), benchmark_results(), Existing::kRefuse), InputError);
  write_benchmark(file(), {"other", "", 1, {}}, Existing::kReplace);
  EXPECT_EQ(read_benchmark(file()).name, "other");
}

TEST_F(BenchmarkResults, OfAnotherKindOrDamagedAreRefused) {
  EXPECT_THROW(static_cast<void>(read_benchmark(folder_ / "none.sqlite")), InputError);
  put(folder_ / "text.sqlite", "no results at all, and long enough to be looked at as a file");
  EXPECT_THROW(static_cast<void>(read_benchmark(folder_ / "text.sqlite")), InputError);
  {
    Database database(folder_ / "other.sqlite", OpenAs::kNew);
    database.run("CREATE TABLE a (b)");
  }
  EXPECT_THROW(static_cast<void>(read_benchmark(folder_ / "other.sqlite")), InputError);
  {
    Database database(file(), OpenAs::kWrite);
    database.run("UPDATE asked SET outcome = 'lucky' WHERE number = 3");
  }
  EXPECT_THROW(static_cast<void>(read_benchmark(file())), InputError);
}

TEST_F(BenchmarkResults, SayWhatTheyHoldAndWhatCanBeChosen) {
  const ordered_json state = BenchmarkView(file()).state();
  EXPECT_EQ(state.at("count"), 30);
  EXPECT_EQ(state.at("item"), "case");
  EXPECT_THAT(state.at("subtitle").get<std::string>(), HasSubstr("seed 5"));
  std::vector<std::string> keys;
  for (const ordered_json& filter : state.at("filters")) keys.push_back(filter.at("key"));
  EXPECT_THAT(keys, ElementsAre("effect", "joint", "group", "outcome"));
}

TEST_F(BenchmarkResults, AreCountedByEffectAndGroup) {
  const json whole = table({}, "Effect by effect");
  ASSERT_EQ(whole.at("rows").size(), 1U);
  const json& row = whole.at("rows").at(0);
  EXPECT_EQ(row.at(0), "coulomb friction");
  EXPECT_EQ(row.at(1), 30);
  EXPECT_EQ(row.at(2), 21);
  EXPECT_EQ(row.at(3), 3);
  EXPECT_EQ(row.at(4), 6);
  EXPECT_NEAR(row.at(5).get<double>(), 80, 1e-9);
  EXPECT_LT(row.at(6).get<double>(), 80);
  EXPECT_GT(row.at(7).get<double>(), 80);
  EXPECT_EQ(row.at(8), "explained (6)");
  EXPECT_THAT(whole.at("note").get<std::string>(), HasSubstr("named that is not there: 1 of 30"));
  const json groups = table({}, "Group by group");
  ASSERT_EQ(groups.at("rows").size(), 3U) << "two, and all";
  const json second = table({{"joint", "2"}}, "Effect by effect");
  EXPECT_EQ(second.at("rows").at(0).at(1), 15);
  EXPECT_EQ(second.at("rows").at(0).at(4), 3);
}

TEST_F(BenchmarkResults, ShowHowSmallAnEffectIsFound) {
  const json figures = BenchmarkView(file()).figures({});
  const json& size = figures.at("sections").at(0).at("blocks").at(0);
  ASSERT_EQ(size.at("title"), "Answered, over the size");
  const json& bars = size.at("series").at(0).at("y");
  EXPECT_EQ(bars.front(), 40) << "six of the first ten are missed";
  EXPECT_EQ(bars.back(), 100);
}

TEST_F(BenchmarkResults, AreListedByOutcome) {
  const BenchmarkView view(file());
  EXPECT_EQ(view.runs({}, 0).at("count"), 30);
  EXPECT_EQ(view.runs({{"outcome", "missed"}}, 0).at("count"), 6);
  EXPECT_EQ(view.runs({{"outcome", "missed"}, {"joint", "1"}}, 0).at("count"), 3);
  EXPECT_EQ(view.runs({{"outcome", "in_class"}}, 0).at("count"), 3);
  const ordered_json wrong = view.runs({{"outcome", "wrong"}}, 0);
  ASSERT_EQ(wrong.at("count"), 1);
  EXPECT_EQ(wrong.at("runs").at(0).at("run"), 20);
  EXPECT_EQ(wrong.at("runs").at(0).at("cells").at(3).at("words"), "not there: backlash@1");
  EXPECT_EQ(wrong.at("runs").at(0).at("cells").at(3).at("level"), "bad");
  EXPECT_EQ(view.runs({{"outcome", "failed"}}, 0).at("runs").at(0).at("run"), 21);
  EXPECT_EQ(view.runs({}, 27).at("runs").size(), 3U);
  EXPECT_THROW(static_cast<void>(view.runs({{"outcome", "lucky"}}, 0)), Refused);
  EXPECT_THROW(static_cast<void>(view.figures({{"colour", "red"}})), Refused);
}

TEST_F(BenchmarkResults, OpenACaseWhereItWasWritten) {
  const std::filesystem::path own = folder_ / "cases" / "small-004";
  std::filesystem::create_directories(own);
  BenchmarkView view(file());
  const SessionFiles files = view.record(4);
  EXPECT_EQ(files.robot.path, (own / "robot.toml").string());
  ASSERT_EQ(files.logs.size(), 1U);
  EXPECT_THAT(files.logs[0].path, EndsWith("recording.csv"));
  EXPECT_TRUE(files.holdout.empty());
  put(own / "holdout.csv", "t,q1\n");
  EXPECT_EQ(view.record(4).holdout.size(), 1U);
  EXPECT_THROW(static_cast<void>(view.record(5)), Refused) << "not written";
  EXPECT_THROW(static_cast<void>(view.record(30)), Refused);
}

}  // namespace
