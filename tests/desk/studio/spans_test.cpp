#include "studio/spans.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "desk/studio/studio_input.hpp"
#include "desk/support/temporary_folder.hpp"

namespace {

using offnominal::EffectKind;
using offnominal::test::studio_input;
using offnominal::test::TemporaryFolder;
using namespace offnominal::desk;
using namespace offnominal::desk::studio;
using ::testing::HasSubstr;

class StudioSpans : public ::testing::Test {
 protected:
  TemporaryFolder folder_;

  static DataFault fault(Eigen::Index joint, const std::string& file) {
    DataFault made;
    made.kind = DataFaultKind::kStuck;
    made.joint = joint;
    made.file = file;
    made.spans.push_back({{}, 1, 2, 3.0, 4.5});
    return made;
  }
  static bool has(const std::vector<report::SpanMark>& spans, const std::string& label) {
    return std::any_of(spans.begin(), spans.end(),
                       [&](const auto& span) { return span.label == label; });
  }
};

TEST_F(StudioSpans, MarkWhatTheDoctorFoundOnItsJointAndRecording) {
  Input input = studio_input(folder_ / "arm.toml", true);
  auto treated = std::make_shared<Treated>(*input.recordings);
  treated->faults = {fault(1, "fitted.csv")};
  input.recordings = treated;
  const Workbench bench(std::move(input));
  const auto spans = spans_of(bench, {.joint = 1}, nullptr);
  const auto stuck = std::find_if(spans.begin(), spans.end(),
                                  [](const auto& span) { return span.label == "stuck"; });
  ASSERT_NE(stuck, spans.end());
  EXPECT_EQ(stuck->from, 3.0);
  EXPECT_EQ(stuck->to, 4.5);
  EXPECT_FALSE(has(spans_of(bench, {.joint = 0}, nullptr), "stuck"));
  EXPECT_FALSE(has(spans_of(bench, {.joint = 1, .recording = 1}, nullptr), "stuck"));
}

TEST_F(StudioSpans, MarkWhatASearchFoundInTime) {
  const Workbench bench(studio_input(folder_ / "arm.toml", true));
  Explanation explanation;
  explanation.pushes.push_back({"fitted.csv", 2, 2.4, {{1, 5, "N m"}}, 1.9, 3});
  Change change;
  change.what = {EffectKind::kCoulombFriction, 1};
  change.at_s = 6;
  explanation.changes.push_back(change);
  explanation.loud.push_back({1, 0, 8, 8.2});
  const auto spans = spans_of(bench, {.joint = 1}, &explanation);
  EXPECT_TRUE(has(spans, "pushed from outside"));
  EXPECT_TRUE(has(spans, "changed: coulomb friction"));
  EXPECT_TRUE(has(spans, "the error stands out"));
  const auto of_other = spans_of(bench, {.joint = 0}, &explanation);
  EXPECT_FALSE(has(of_other, "changed: coulomb friction"));
  EXPECT_FALSE(has(of_other, "pushed from outside"));
  EXPECT_FALSE(has(spans_of(bench, {.joint = 1, .recording = 1}, &explanation),
                   "changed: coulomb friction"));
  // They come to the charts over time, and to no other.
  const nlohmann::json charts = charts_of(bench, bench.now(), {.joint = 1}, spans);
  EXPECT_EQ(charts.at(0).at("spans").size(), spans.size());
  EXPECT_TRUE(charts.at(2).at("spans").empty());
}

TEST_F(StudioSpans, LayAnotherRecordingOverTheFirst) {
  const Workbench bench(studio_input(folder_ / "arm.toml", true));
  const nlohmann::json charts = charts_of(bench, bench.now(), {.joint = 1, .beside = 1});
  EXPECT_EQ(charts.at(0).at("series").size(), 3U);
  EXPECT_EQ(charts.at(1).at("series").at(1).at("name"), "error now, held_out.csv");
  EXPECT_NEAR(charts.at(1).at("series").at(1).at("x").at(0).get<double>(),
              charts.at(1).at("series").at(0).at("x").at(0).get<double>(), 1e-9);
}

}  // namespace
