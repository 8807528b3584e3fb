#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "desk/campaign/small_campaign.hpp"
#include "desk/support/run_command.hpp"
#include "support/places.hpp"

// `offnominal campaign` as a user runs it.

namespace offnominal::desk {
namespace {

using test::CommandResult;
using testing::HasSubstr;
using testing::StartsWith;

class CampaignVerb : public testing::Test {
 protected:
  CampaignVerb() { test::put(folder_ / "small.toml", test::small_campaign()); }

  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_ / name).string();
  }
  static CommandResult campaign(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "campaign");
    return test::run_command(test::command_file(), std::move(arguments));
  }

  test::TemporaryFolder folder_;
};

TEST_F(CampaignVerb, RunsMergesAndShows) {
  const CommandResult first =
      campaign({path("small.toml"), "-o", path("1.sqlite"), "--shard", "1/2", "--json"});
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(nlohmann::json::parse(first.out).at("missing").size(), 5U);
  ASSERT_EQ(campaign({path("small.toml"), "-o", path("2.sqlite"), "--shard", "2/2"}).exit_code, 0);

  const CommandResult half = campaign({"merge", path("1.sqlite"), "-o", path("half.sqlite")});
  EXPECT_EQ(half.exit_code, 1) << half.err;
  EXPECT_THAT(half.out, HasSubstr("missing: 5 runs (1, 3, 5, 7, 9)"));

  const CommandResult merged =
      campaign({"merge", path("1.sqlite"), path("2.sqlite"), "-o", path("all.sqlite")});
  EXPECT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_THAT(merged.out, StartsWith("campaign small: 11 of 11 runs\n"));
  EXPECT_THAT(merged.out, HasSubstr("written: " + path("all.sqlite")));
  EXPECT_EQ(campaign({"merge", path("1.sqlite"), "-o", path("all.sqlite")}).exit_code, 2);

  const CommandResult shown = campaign({"show", path("all.sqlite"), "--report", path("page.html")});
  EXPECT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_THAT(merged.out, HasSubstr(shown.out.substr(0, shown.out.find("written"))));
  EXPECT_THAT(test::content_of(folder_ / "page.html"),
              HasSubstr("Faults seen against false alarms"));
  const auto json = nlohmann::json::parse(campaign({"show", path("all.sqlite"), "--json"}).out);
  EXPECT_EQ(json.at("detectors").size(), 4U);
  EXPECT_EQ(json.at("detectors")[0].at("faults").size(), 4U);
}

TEST_F(CampaignVerb, RefusesInOneLine) {
  const std::vector<std::vector<std::string>> wrong{
      {},
      {path("small.toml")},
      {path("small.toml"), "-o", path("small.toml")},
      {path("small.toml"), "-o", path("a.sqlite"), "--shard", "3/2"},
      {path("none.toml"), "-o", path("a.sqlite")},
      {"show", path("none.sqlite")},
      {"merge", path("none.sqlite"), "-o", path("a.sqlite")}};
  for (const auto& arguments : wrong) {
    const CommandResult result = campaign(arguments);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.sqlite"));
}

}  // namespace
}  // namespace offnominal::desk
