#include "paper/figures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "desk/paper/quick_arm.hpp"

namespace offnominal::desk::paper {
namespace {

using testing::HasSubstr;

const PaperRuns& paper_runs() {
  static const PaperRuns runs = run_everything(test::quick_arm(), {});
  return runs;
}

std::vector<const report::Chart*> charts_of(const report::Page& page) {
  std::vector<const report::Chart*> charts;
  for (const report::Section& section : page.sections) {
    for (const report::Block& block : section.blocks) {
      if (const auto* chart = std::get_if<report::Chart>(&block)) charts.push_back(chart);
    }
  }
  return charts;
}

report::Page full_page() {
  const auto lines = compare_with_paper(paper_runs());
  return page_of(paper_runs(), lines, verdict_of(lines, true), "offnominal paper");
}

TEST(PaperFigures, PageHoldsFiguresEightToFifteen) {
  const report::Page page = full_page();
  for (int number = 8; number <= 15; ++number) {
    const std::string start = "Figure " + std::to_string(number) + ":";
    int found = 0;
    for (const report::Chart* chart : charts_of(page)) found += chart->title.starts_with(start);
    EXPECT_EQ(found, number == 10 || number == 13 ? 1 : 2) << start;
  }
  EXPECT_NO_THROW(static_cast<void>(report::to_json(page)));
}

TEST(PaperFigures, ChartsMarkFaultAndDetection) {
  const report::Page page = full_page();
  const auto charts = charts_of(page);
  ASSERT_FALSE(charts.empty());
  const auto& events = charts.front()->events;
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].x, 10.0);
  EXPECT_NEAR(events[1].x, 10.575, 1.5 * test::kPaperTickS);
}

TEST(PaperFigures, EveryMeasurableResultAgreesWithThePaper) {
  for (const Comparison& line : compare_with_paper(paper_runs())) {
    EXPECT_TRUE(line.agrees.value_or(true)) << line.what << ": " << line.here;
  }
  EXPECT_THAT(verdict_of(compare_with_paper(paper_runs()), true), HasSubstr("agree"));
}

TEST(PaperFigures, DifferenceFromThePaperIsNamed) {
  const std::vector<Comparison> lines{{"detected at", "10.6 s", "12.1 s", false}};
  EXPECT_THAT(verdict_of(lines, true), HasSubstr("detected at: 12.1 s here, 10.6 s in the paper"));
  EXPECT_THAT(verdict_of(lines, false), HasSubstr("settings are not the paper's"));
}

TEST(PaperFigures, LateDetectionMissedFaultAndFalseAlarmDoNotAgree) {
  PaperRuns runs;
  runs.healthy.detection_time_s = 3.0;
  runs.healthy.max_abs_psi_hat_before_fault = 1e-9;
  runs.healthy.max_error_to_threshold_before_fault = 1.0;
  runs.mass_loss.detection_time_s = 10.71;
  runs.mass_loss.max_weight_norm = 10.1;
  runs.mass_loss.tracking_rms_rad = 1.0;
  runs.mass_loss_accommodated.tracking_rms_rad = 0.51;
  runs.nonlinear.tracking_rms_rad = 1.0;
  runs.nonlinear_accommodated.tracking_rms_rad = 0.51;
  runs.sweep.probes = {{0.075, 15.0}, {0.1, 14.0}};
  for (const Comparison& line : compare_with_paper(runs)) {
    EXPECT_FALSE(line.agrees.value_or(false)) << line.what;
  }
}

TEST(PaperFigures, PageOfOneRunSaysWhatHappened) {
  const report::Page page = page_of(paper_runs().mass_loss, "offnominal paper --fault mass_loss");
  EXPECT_THAT(page.verdict.words, HasSubstr("begins at 10 s is detected at 10.57"));
  EXPECT_EQ(page.verdict.level, report::Level::kGood);
  EXPECT_EQ(charts_of(page).size(), 5U);
  EXPECT_NO_THROW(static_cast<void>(report::to_json(page)));
}

TEST(PaperFigures, FalseAlarmAndMissedFaultAreWarnedOf) {
  ExperimentResult run = paper_runs().healthy;
  EXPECT_EQ(page_of(run, "").verdict.level, report::Level::kGood);
  run.detection_time_s = 3.0;
  EXPECT_EQ(page_of(run, "").verdict.level, report::Level::kWarn);
  EXPECT_THAT(words_of(run), HasSubstr("no fault, but an alarm at 3.000 s"));
  run.fault = sim::FaultKind::kMassLoss;
  run.fault_time_s = 10.0;
  EXPECT_THAT(words_of(run), HasSubstr("False alarm"));
  run.detection_time_s.reset();
  EXPECT_THAT(words_of(run), HasSubstr("not detected"));
  EXPECT_EQ(page_of(run, "").verdict.level, report::Level::kWarn);
}

}  // namespace
}  // namespace offnominal::desk::paper
