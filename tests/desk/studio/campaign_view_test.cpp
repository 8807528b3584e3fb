// A campaign's results behind the server: what its figures and runs say, and a run that is opened.
#include "studio/campaign_view.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "campaign/campaign_file.hpp"
#include "campaign/restored_campaign.hpp"
#include "campaign/summary.hpp"
#include "common/error.hpp"
#include "common/refused.hpp"
#include "desk/studio/served_studio.hpp"
#include "desk/studio/small_results.hpp"
#include "desk/support/temporary_folder.hpp"
#include "log/csv_text.hpp"
#include "robot/robot_file.hpp"

namespace {

using nlohmann::json;
using nlohmann::ordered_json;
using offnominal::test::content_of;
using offnominal::test::open_run;
using offnominal::test::put;
using offnominal::test::ServedStudio;
using offnominal::test::small;
using offnominal::test::TemporaryFolder;
using namespace offnominal::desk;
using namespace offnominal::desk::studio;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

CampaignView view_of(bool with_file) {
  return {small().results().string(),
          with_file ? std::optional(small().file().string()) : std::nullopt};
}

const json* block_titled(const json& figures, const std::string& title) {
  for (const json& section : figures.at("sections")) {
    for (const json& block : section.at("blocks")) {
      if (block.value("title", "") == title || block.value("caption", "") == title) return &block;
    }
  }
  return nullptr;
}

TEST(CampaignView, SaysWhatTheResultsHold) {
  const ordered_json state = view_of(false).state();
  EXPECT_EQ(state.at("name"), "small");
  EXPECT_EQ(state.at("count"), small().plan().run_count());
  EXPECT_THAT(state.at("subtitle").get<std::string>(), Not(HasSubstr(" of ")));
  const auto values_of = [&](const std::string& key) {
    std::vector<std::string> values;
    for (const ordered_json& filter : state.at("filters")) {
      if (filter.at("key") != key) continue;
      for (const ordered_json& one : filter.at("options")) values.push_back(one.at("value"));
    }
    return values;
  };
  EXPECT_EQ(values_of("detector").size(), 5U) << "all, or one of four";
  EXPECT_THAT(state.dump(), HasSubstr("momentum observer, filter of "));
  EXPECT_THAT(values_of("kind"), ElementsAre("", "offset", "payload"));
  EXPECT_THAT(values_of("joint"), ElementsAre("", "1", "2"));
  EXPECT_THAT(values_of("outcome"), ElementsAre("", "missed", "early"));
}

TEST(CampaignView, CountsEveryRunWithAFaultInTheTimesToDetect) {
  const json figures = view_of(false).figures({});
  const json* delays = block_titled(figures, "Time from fault to alarm");
  ASSERT_NE(delays, nullptr);
  const campaign::Summary summary = campaign::summary_of(small().rows());
  for (std::size_t i = 0; i < summary.detectors.size(); ++i) {
    const campaign::DetectorSummary& detector = summary.detectors[i];
    std::int64_t seen = 0;
    std::int64_t runs = 0;
    for (const campaign::FaultLine& line : detector.faults) {
      seen += line.seen;
      runs += line.runs;
    }
    const json& series = delays->at("series").at(i);
    EXPECT_EQ(series.at("name"), detector.name);
    EXPECT_NEAR(series.at("y").back().get<double>(),
                100.0 * static_cast<double>(seen) / static_cast<double>(runs), 1e-4);
  }
}

TEST(CampaignView, FiltersFiguresAndRunsByFaultJointAndDetector) {
  const CampaignView view = view_of(false);
  const std::string first = small().rows().campaign.detectors.front().name;
  const ResultsFilter filter{{"detector", first}, {"kind", "offset"}, {"joint", "2"}};
  const json figures = view.figures(filter);
  const json* table = block_titled(figures, first);
  ASSERT_NE(table, nullptr);
  EXPECT_EQ(table->at("rows").size(), 2U);  // two sizes
  EXPECT_EQ(block_titled(figures, small().rows().campaign.detectors.back().name), nullptr);
  // Fault-free runs stay: false alarms are of them.
  EXPECT_NE(block_titled(figures, "False alarms of fault-free runs"), nullptr);
  const ordered_json runs = view.runs(filter, 0);
  EXPECT_EQ(runs.at("count"), 4);
  for (const ordered_json& run : runs.at("runs")) {
    EXPECT_EQ(run.at("cells").at(0).at("words"), "offset, joint 2");
    EXPECT_EQ(run.at("cells").size(), 3U) << "fault, size, and one detector";
  }
  EXPECT_EQ(view.runs({}, 0).at("count"), small().plan().run_count());
  EXPECT_EQ(view.runs({}, 3).at("runs").at(0).at("run"), 3);
  const ordered_json missed = view.runs({{"outcome", "missed"}}, 0);
  EXPECT_LT(missed.at("count"), view.runs({}, 0).at("count"));
  for (const char* key : {"detector", "kind", "joint", "outcome"}) {
    try {
      static_cast<void>(view.runs({{key, "77"}}, 0));
      ADD_FAILURE() << key << " may be 77";
    } catch (const Refused& refused) {
      EXPECT_THAT(refused.what(), HasSubstr(std::string(key) + " is \"77\"; allowed: "));
    }
    EXPECT_THROW(static_cast<void>(view.figures({{key, "77"}})), Refused) << key;
  }
  EXPECT_THROW(static_cast<void>(view.runs({{"outcome", "no_such"}}, 0)), Refused);
  EXPECT_THROW(static_cast<void>(view.runs({{"no_such", "filter"}}, 0)), Refused);
}

TEST(CampaignView, RecordsARunAsTheVerbDoesWithTheFileAndWithout) {
  const campaign::Simulator simulator(small().plan());
  const std::string same = csv_text(simulator.run(campaign::run_of(small().plan(), 2)).log);
  for (const bool with_file : {true, false}) {
    CampaignView view = view_of(with_file);
    const SessionFiles files = view.record(2);
    EXPECT_EQ(content_of(files.logs.at(0).path), same) << with_file;
    EXPECT_EQ(content_of(files.robot.path), robot_text(small().plan().model)) << with_file;
    EXPECT_EQ(files.logs.at(0).name, "run_2.csv");
    EXPECT_THAT(files.commands_before.at(0), HasSubstr("campaign record"));
    EXPECT_THAT(files.commands_before.at(0),
                HasSubstr(with_file ? small().file().string() : "CAMPAIGN.toml"));
    ASSERT_FALSE(files.marks.empty());
    EXPECT_EQ(files.marks.at(0).x, 0.8);
    EXPECT_THROW(static_cast<void>(view.record(-1)), Refused);
    EXPECT_THROW(static_cast<void>(view.record(small().plan().run_count())), Refused);
  }
}

TEST(CampaignView, ShowsWhatAMonitorSawAsTheResultsHaveIt) {
  CampaignView view = view_of(false);
  const ordered_json monitors = view.state().at("monitors");
  ASSERT_EQ(monitors.size(), 2U) << "peers have no residual of ours";
  int seen = 0;
  for (const campaign::Result& row : small().rows().rows) {
    if (std::find(monitors.begin(), monitors.end(), row.detector) == monitors.end()) continue;
    if (row.fault_s && !row.detected && !row.early) {
      EXPECT_EQ(view.watched(row.run, row.detector).at("level"), "warn") << "missed";
    }
    if (!row.fault_s || !row.detected || row.early || !row.delay_s) continue;
    ++seen;
    const json watched = view.watched(row.run, row.detector);
    EXPECT_EQ(watched.at("level"), "bad");
    const json& figures = watched.at("sections").at(0).at("blocks").at(0).at("figures");
    EXPECT_NEAR(figures.at(0).at("value").get<double>(), *row.fault_s + *row.delay_s, 1e-9)
        << row.detector << ", run " << row.run;
    const json* chart = block_titled(watched, row.detector.starts_with("torque")
                                                  ? "Residual against its threshold, joint1"
                                                  : "Residual against its threshold");
    ASSERT_NE(chart, nullptr);
    EXPECT_EQ(chart->at("events").back().at("label"), row.kind);
  }
  EXPECT_GE(seen, 4);
  const std::string peer = small().rows().campaign.detectors.back().name;
  EXPECT_THROW(static_cast<void>(view.watched(0, peer)), Refused);
  EXPECT_THROW(static_cast<void>(view.watched(0, "no_such")), Refused);
  EXPECT_THROW(static_cast<void>(view.watched(-1, monitors.at(0))), Refused);
}

TEST(CampaignView, RefusesTheFileOfAnotherCampaignAndResultsOfAnotherVersion) {
  const TemporaryFolder folder;
  std::string text = content_of(small().file());
  text.replace(text.find("seed = 7"), 8, "seed = 8");
  put(folder / "other.toml", text);
  try {
    const CampaignView view(small().results().string(), (folder / "other.toml").string());
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("another campaign"));
  }
  for (const std::string& identity :
       {std::string("offnominal 0.0.1"), "x" + small().rows().campaign.identity,
        std::string("\n\n# robot\n\n# plant\n")}) {
    EXPECT_THROW(
        static_cast<void>(campaign::restored_campaign(identity, folder.path(), "a.sqlite")),
        InputError);
  }
  EXPECT_THROW(CampaignView((folder / "other.toml").string(), std::nullopt), InputError);
}

TEST(CampaignServer, OpensARunAsASession) {
  ServedStudio studio(std::make_unique<CampaignView>(small().results().string(), std::nullopt),
                      open_run);
  EXPECT_TRUE(studio.get("live").second.at("has_results").get<bool>());
  EXPECT_EQ(studio.get("state").first, 409);
  EXPECT_EQ(studio.get("results/runs?from=0&kind=offset").first, 200);
  for (const char* wrong : {"results/runs", "results/runs?from=-1", "results/figures?colour=x",
                            "results/figures?detector=<img>"}) {
    EXPECT_EQ(studio.get(wrong).first, 400) << wrong;
  }
  EXPECT_EQ(studio.post("results/session", {{"run", 1'000'000}}).first, 400);
  EXPECT_EQ(studio.post("results/session").first, 400);
  ASSERT_EQ(studio.post("results/session", {{"run", 2}}).first, 200);
  const json state = studio.get("state").second;
  EXPECT_EQ(state.at("recordings").at(0).at("samples"), 750);
  const json charts = studio.get("charts?joint=1&recording=1&pixels=300").second;
  EXPECT_EQ(charts.at("charts").at(0).at("events").at(0).at("label"), "offset");
  ASSERT_EQ(studio.post("steps", {{"effect", "torque_offset"}, {"joint", 1}}).first, 200);
  EXPECT_EQ(studio.post("results/session", {{"run", 3}}).first, 409);
  EXPECT_EQ(studio.post("results/session", {{"run", 3}, {"replace", true}}).first, 200);
}

}  // namespace
