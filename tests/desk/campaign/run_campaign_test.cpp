#include "campaign/run_campaign.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "campaign/result_file.hpp"
#include "campaign/summary.hpp"
#include "campaign/summary_report.hpp"
#include "common/error.hpp"
#include "desk/campaign/small_campaign.hpp"

namespace offnominal::desk::campaign {
namespace {

using test::campaign_of;
using test::content_of;
using test::put;
using test::small_campaign;
using testing::AllOf;
using testing::HasSubstr;

// Everything that is said of results, every digit.
std::string said_of(const Results& results) {
  const Summary summary = summary_of(results);
  return text_of(summary) + to_json(summary).dump(1);
}

template <typename Work>
std::string refused(const Work& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was refused";
}

class CampaignRun : public testing::Test {
 protected:
  RunOutcome run(const std::string& name, const Shard& shard = {}, int threads = 1) {
    return run_campaign(campaign_, {folder_ / name, shard, threads}, {});
  }

  test::TemporaryFolder folder_;
  Campaign campaign_ = campaign_of(small_campaign());
};

TEST_F(CampaignRun, SaysTheSameOfOneProcessOfThreadsAndOfShardsThatAreMerged) {
  run("one.sqlite");
  const Results one = read_results(folder_ / "one.sqlite");
  EXPECT_TRUE(one.missing.empty());
  EXPECT_EQ(one.rows.size(), static_cast<std::size_t>(campaign_.run_count()) * 4);
  // What is compared is not nothing.
  EXPECT_THAT(said_of(one), HasSubstr("100.0"));

  run("threads.sqlite", {}, 2);
  EXPECT_EQ(said_of(read_results(folder_ / "threads.sqlite")), said_of(one));

  std::vector<std::filesystem::path> parts;
  for (std::int64_t i = 1; i <= 8; ++i) {
    const std::string name = "part" + std::to_string(i);
    run(name, {i, 8});
    parts.insert(parts.begin(), folder_ / name);
  }
  write_results(folder_ / "all.sqlite", merged(parts), Existing::kRefuse);
  const Results all = read_results(folder_ / "all.sqlite");
  EXPECT_EQ(all.rows, one.rows);
  EXPECT_EQ(said_of(all), said_of(one));

  // One part less: what it should have held is missing.
  const Results less = merged({parts.begin() + 1, parts.end()});
  EXPECT_EQ(less.missing, (std::vector<std::int64_t>{7}));
  EXPECT_THAT(said_of(less), HasSubstr("missing: 1 run (7)"));
}

TEST_F(CampaignRun, GoesOnWhereItWasInterrupted) {
  run("a.sqlite", {1, 2});
  const Results half = read_results(folder_ / "a.sqlite");
  EXPECT_EQ(half.missing, (std::vector<std::int64_t>{1, 3, 5, 7, 9}));
  const RunOutcome rest = run("a.sqlite");
  EXPECT_EQ(rest.runs, 11);
  EXPECT_EQ(rest.skipped, 6);
  const Results whole = read_results(folder_ / "a.sqlite");
  EXPECT_TRUE(whole.missing.empty());
  run("b.sqlite");
  EXPECT_EQ(whole.rows, read_results(folder_ / "b.sqlite").rows);
}

TEST_F(CampaignRun, RefusesResultsOfAnotherCampaignAndLeavesThemAsTheyAre) {
  run("a.sqlite", {1, 11});
  const std::string before = content_of(folder_ / "a.sqlite");
  std::string other_text = small_campaign();
  other_text.replace(other_text.find("seed = 7"), 8, "seed = 8");
  const Campaign other = campaign_of(other_text);
  EXPECT_THAT(refused([&] {
                run_campaign(other, {folder_ / "a.sqlite", {}, 1}, {});
              }),
              HasSubstr("results of another campaign (small)"));
  EXPECT_EQ(content_of(folder_ / "a.sqlite"), before);

  run_campaign(other, {folder_ / "b.sqlite", {1, 11}, 1}, {});
  EXPECT_THAT(refused([&] {
                static_cast<void>(merged({folder_ / "a.sqlite", folder_ / "b.sqlite"}));
              }),
              AllOf(HasSubstr("b.sqlite"), HasSubstr("another campaign")));
}

TEST_F(CampaignRun, RefusesWhatIsDamagedOrNoResultsAndLosesNothing) {
  run("a.sqlite", {1, 11});
  std::string damaged = content_of(folder_ / "a.sqlite");
  for (std::size_t i = 4096; i < damaged.size(); i += 2) damaged[i] = '\x5a';
  put(folder_ / "damaged.sqlite", damaged);
  put(folder_ / "text.sqlite", "these are my notes of 20 years\n");
  for (const char* name : {"damaged.sqlite", "text.sqlite"}) {
    const std::string before = content_of(folder_ / name);
    EXPECT_THAT(refused([&] { run(name); }),
                AllOf(HasSubstr(name), HasSubstr("damaged"), HasSubstr("left as it is")));
    EXPECT_THAT(refused([&] { static_cast<void>(read_results(folder_ / name)); }),
                HasSubstr("damaged"));
    EXPECT_EQ(content_of(folder_ / name), before);
  }
  EXPECT_THAT(refused([&] { static_cast<void>(read_results(folder_ / "nowhere.sqlite")); }),
              HasSubstr("no such file"));
}

TEST_F(CampaignRun, RefusesToMergeFilesThatDisagreeAboutARun) {
  run("a.sqlite", {1, 11});
  Results changed = read_results(folder_ / "a.sqlite");
  write_results(folder_ / "same.sqlite", changed, Existing::kRefuse);
  EXPECT_EQ(merged({folder_ / "a.sqlite", folder_ / "same.sqlite"}).rows, changed.rows);
  changed.rows.front().peak_after += 1e-9;
  write_results(folder_ / "other.sqlite", changed, Existing::kRefuse);
  EXPECT_THAT(refused([&] {
                static_cast<void>(merged({folder_ / "a.sqlite", folder_ / "other.sqlite"}));
              }),
              HasSubstr("another result"));
}

TEST(RunList, NamesStretches) {
  EXPECT_EQ(run_list({1, 2, 3, 7, 9, 10}), "1 to 3, 7, 9 to 10");
  EXPECT_EQ(run_list({}), "");
}

}  // namespace
}  // namespace offnominal::desk::campaign
