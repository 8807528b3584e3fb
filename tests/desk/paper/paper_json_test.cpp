#include "paper/paper_json.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>

namespace offnominal::desk::paper {
namespace {

ExperimentResult detected_run() {
  ExperimentResult run;
  run.fault = sim::FaultKind::kMassLoss;
  run.precision = Precision::kDouble;
  run.seed = 7;
  run.steps = 20000;
  run.fault_time_s = 10.0;
  run.detection_time_s = 10.577;
  run.fault_estimate_relative_error = 0.25;
  return run;
}

TEST(PaperJson, OneRunHasEveryKey) {
  const auto json = to_json(detected_run());
  for (const char* key :
       {"fault", "fault_time_s", "detection_time_s", "max_error_to_threshold_before_fault",
        "max_abs_psi_hat_before_fault", "tracking_rms_rad", "fault_estimate_relative_error",
        "max_weight_norm", "steps", "scalar", "seed"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_EQ(json["fault"], "mass_loss");
  EXPECT_EQ(json["scalar"], "double");
  EXPECT_EQ(json["steps"], 20000);
  EXPECT_EQ(json["seed"], 7);
  EXPECT_EQ(json["detection_time_s"], 10.577);
}

TEST(PaperJson, WhatThereIsNotIsNull) {
  ExperimentResult run;
  run.fault = sim::FaultKind::kNone;
  const auto json = to_json(run);
  EXPECT_EQ(json["fault"], "none");
  EXPECT_TRUE(json["fault_time_s"].is_null());
  EXPECT_TRUE(json["detection_time_s"].is_null());
  EXPECT_TRUE(json["fault_estimate_relative_error"].is_null());
}

TEST(PaperJson, SweepListsEveryProbe) {
  SweepResult sweep;
  sweep.probes = {{0.09, std::nullopt}, {0.095, 17.4}};
  sweep.smallest_detected = 0.095;
  sweep.largest_undetected = 0.09;
  const auto json = to_json(sweep);
  EXPECT_EQ(json["smallest_detected_mass_loss"], 0.095);
  EXPECT_EQ(json["largest_undetected_mass_loss"], 0.09);
  ASSERT_EQ(json["probes"].size(), 2U);
  EXPECT_TRUE(json["probes"][0]["detection_time_s"].is_null());
  EXPECT_EQ(json["probes"][1]["detection_time_s"], 17.4);
}

TEST(PaperJson, EverythingHoldsFiveRunsAndTheComparison) {
  PaperRuns runs;
  const std::vector<Comparison> lines{{"a", "1", "1", true}, {"b", "good", "24 %", std::nullopt}};
  const auto json = to_json(runs, lines, "words");
  EXPECT_EQ(json["runs"].size(), 5U);
  EXPECT_EQ(json["comparison"][0]["agrees"], true);
  EXPECT_TRUE(json["comparison"][1]["agrees"].is_null());
  EXPECT_EQ(json["verdict"], "words");
}

}  // namespace
}  // namespace offnominal::desk::paper
