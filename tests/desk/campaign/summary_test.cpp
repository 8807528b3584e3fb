#include "campaign/summary.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "campaign/result_numbers.hpp"
#include "campaign/score.hpp"
#include "desk/campaign/small_campaign.hpp"

namespace offnominal::desk::campaign {
namespace {

TEST(Estimates, AreThoseOfTables) {
  // Clopper-Pearson, 95 %: 8 of 10 is 0.4439 to 0.9748; none of 10 up to 0.3085.
  const Estimate share = share_of(8, 10);
  EXPECT_NEAR(share.low, 0.4439, 1e-4);
  EXPECT_NEAR(share.high, 0.9748, 1e-4);
  EXPECT_EQ(share_of(0, 10).low, 0);
  EXPECT_NEAR(share_of(0, 10).high, 0.3085, 1e-4);
  EXPECT_EQ(share_of(10, 10).high, 1);
  // Poisson, 95 %: 3 events are 0.6187 to 8.7673; none up to 3.6889.
  EXPECT_NEAR(rate_of(3, 1).low, 0.6187, 1e-4);
  EXPECT_NEAR(rate_of(3, 1).high, 8.7673, 1e-4);
  EXPECT_NEAR(rate_of(0, 2).high, 3.6889 / 2, 1e-4);
}

// Of a run of 1 s with one joint's ratio at every 0.1 s.
Judged judged(const std::vector<double>& ratios) {
  Judged all{Eigen::VectorXd(static_cast<Eigen::Index>(ratios.size())),
             Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(ratios.size()), 2)};
  for (std::size_t i = 0; i < ratios.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    all.t_s[row] = 0.1 * static_cast<double>(i);
    all.ratio(row, 1) = ratios[i];
  }
  return all;
}

class Score : public testing::Test {
 protected:
  Score() {
    campaign_.runs.fault_s = 0.5;
    campaign_.plant.velocity = VelocityKind::kSent;
  }

  [[nodiscard]] Result score(const std::vector<double>& ratios, bool fault_free = false) const {
    const campaign::Run run{3, fault_free ? nullptr : &campaign_.faults[2], 1};  // joint 2
    return score_of(campaign_, run, {}, "d", judged(ratios));
  }

  Campaign campaign_ = test::campaign_of(test::small_campaign());
};

TEST_F(Score, IsOfTheFirstAlarmBehindTheFault) {
  const Result seen = score({0, 0.4, 0, 0, 0, 0, 0.9, 1.5, 3, 0.5});
  EXPECT_TRUE(seen.detected);
  EXPECT_NEAR(*seen.delay_s, 0.2, 1e-12);
  EXPECT_EQ(seen.first_joint, 2);
  EXPECT_EQ(seen.joint_right, true);
  EXPECT_EQ(seen.alarms, 1);
  EXPECT_EQ(seen.peak_before, 0.4);
  EXPECT_EQ(seen.peak_after, 3);
}

TEST_F(Score, OfAnAlarmBeforeTheFaultIsNoDetection) {
  const Result early = score({0, 1.2, 0, 0, 0, 0, 0, 2, 0, 0});
  EXPECT_TRUE(early.early);
  EXPECT_FALSE(early.detected);
  EXPECT_FALSE(early.delay_s.has_value());
  EXPECT_EQ(early.alarms, 2);
}

TEST_F(Score, OfAFaultFreeRunCountsItsAlarms) {
  const Result free = score({0, 1.2, 0, 0, 0, 0, 0, 2, 0, 0}, true);
  EXPECT_EQ(free.kind, "none");
  EXPECT_FALSE(free.detected);
  EXPECT_EQ(free.alarms, 2);
  EXPECT_EQ(free.peak_before, 2);
}

TEST_F(Score, ComesBackToTheBitFromItsNumbers) {
  Result seen = score({0, 0.4, 0, 0, 0, 0, 0.9, 1.0 / 0.7, 3, 0.5});
  Result free = score({0, 1.2}, true);
  seen.named = {offnominal::FaultKind::kFriction, 1, 1.0 / 3, 0.7};
  seen.tracking_end_rad = 0.1;
  seen.tracking_end_accommodated_rad = std::numeric_limits<double>::infinity();
  free.run = campaign_.run_count() - 1;
  seen.run = 4;  // of the fault on joint 2
  for (Result* one : {&seen, &free}) {
    one->detector = campaign_.detectors[1].name;
    EXPECT_EQ(result_of(campaign_, numbers_of(campaign_, *one)), *one);
  }
  std::vector<double> wrong = numbers_of(campaign_, seen);
  wrong[14] = 9;
  EXPECT_THROW(static_cast<void>(result_of(campaign_, wrong)), std::invalid_argument);
  wrong = numbers_of(campaign_, seen);
  wrong[0] = 1e6;
  EXPECT_THROW(static_cast<void>(result_of(campaign_, wrong)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(result_of(campaign_, {1, 2})), std::invalid_argument);
}

Result fault_row(std::int64_t run, double size, bool seen, double peak) {
  Result row;
  row.run = run;
  row.detector = "d";
  row.kind = "friction";
  row.joint = 2;
  row.size = size;
  row.fault_s = 3600;
  row.judged_s = 7200;
  row.detected = seen;
  row.peak_after = peak;
  if (seen) {
    row.delay_s = 0.1 * static_cast<double>(run);
    row.first_joint = run == 4 ? 1 : 2;
    row.joint_right = run != 4;
    row.named = run == 5 ? Named{offnominal::FaultKind::kContact, 0, 1, 2}
                         : Named{offnominal::FaultKind::kFriction, 1, 1.1 * size, 0.5};
  }
  return row;
}

TEST(Summary, HasEveryFaultWithItsTimesAndTheSmallestThatIsSeen) {
  Results results;
  results.campaign = {"c", "", 8, {{"d", "", ""}}};
  results.rows = {fault_row(0, 1, false, 0.5), fault_row(1, 1, true, 1.5),
                  fault_row(2, 2, true, 2),    fault_row(3, 2, true, 2),
                  fault_row(4, 4, true, 3),    fault_row(5, 4, true, 3)};
  Result free;
  free.run = 6;
  free.detector = "d";
  free.judged_s = 7200;
  free.alarms = 3;
  free.peak_before = 2.5;
  results.rows.push_back(free);
  results.missing = {7};
  const Summary summary = summary_of(results);
  const DetectorSummary& one = summary.detectors.at(0);
  ASSERT_EQ(one.faults.size(), 3U);
  EXPECT_EQ(one.faults[0].runs, 2);
  EXPECT_EQ(one.faults[0].detected.value, 0.5);
  EXPECT_NEAR(*one.faults[1].median_s, 0.2, 1e-12);
  EXPECT_NEAR(*one.faults[1].max_s, 0.3, 1e-12);
  EXPECT_EQ(one.faults[2].joint_right, 1);
  EXPECT_EQ(one.faults[2].named, 2);
  EXPECT_EQ(one.faults[2].answers(), 2);
  EXPECT_EQ(one.faults[2].kind_right, 1);
  EXPECT_EQ(one.faults[2].kind_and_joint_right, 1);
  EXPECT_NEAR(*one.faults[1].size_off_median, 0.1, 1e-12);
  ASSERT_EQ(one.confusion.size(), 1U);
  EXPECT_EQ(one.confusion[0].seen, 5);
  EXPECT_EQ(one.confusion[0].right, 4);
  EXPECT_EQ(one.confusion[0].named_as.at(static_cast<std::size_t>(offnominal::FaultKind::kContact)),
            1);
  ASSERT_EQ(one.smallest.size(), 1U);
  EXPECT_EQ(one.smallest[0].size, 2);
  EXPECT_EQ(one.smallest[0].runs, 2);
  EXPECT_EQ(one.smallest[0].seen, 2);
  EXPECT_EQ(one.false_alarms, 3);
  EXPECT_NEAR(one.false_alarms_per_hour->value, 1.5, 1e-12);
  // 8 h before faults and without any.
  const auto& roc = one.roc;
  ASSERT_FALSE(roc.empty());
  EXPECT_EQ(roc.back().false_alarms_per_hour, 0);
  EXPECT_EQ(roc.back().detected, 0);
  EXPECT_NEAR(roc.front().false_alarms_per_hour, 1.0 / 8, 1e-12);
  EXPECT_EQ(roc.front().detected, 1);
  // At 2.5 times the thresholds, below which the fault-free run alarms.
  EXPECT_EQ(one.without_false_alarm->scale, 2.5);
  EXPECT_EQ(one.without_false_alarm->false_alarms_per_hour, 0);
  EXPECT_NEAR(one.without_false_alarm->detected, 2.0 / 6, 1e-12);
}

// Of runs of which both are known: 1 to 1/2, 1 to 1/4, 1 to 3, and one that runs away.
TEST(Summary, ComparesTrackingWithAccommodationAndWithout) {
  Results results;
  results.campaign = {"c", "", 6, {{"d", "", ""}}};
  constexpr double kAway = std::numeric_limits<double>::infinity();
  std::int64_t run = 0;
  for (const double with : {0.5, 0.25, 3.0, kAway}) {
    results.rows.push_back(fault_row(run++, 1, true, 2));
    results.rows.back().tracking_end_rad = 1;
    results.rows.back().tracking_end_accommodated_rad = with;
  }
  results.rows.push_back(fault_row(run++, 1, true, 2));
  results.rows.back().tracking_end_rad = 7;
  const Summary summary = summary_of(results);
  const std::vector<Tracking>& tracking = summary.detectors.at(0).tracking;
  ASSERT_EQ(tracking.size(), 1U);
  EXPECT_EQ(tracking[0].kind, "friction");
  EXPECT_EQ(tracking[0].runs, 4);
  EXPECT_EQ(tracking[0].halved, 2);
  EXPECT_EQ(tracking[0].worse, 2);
  EXPECT_EQ(tracking[0].without_rad, 1);
  EXPECT_EQ(tracking[0].with_rad, kAway);
  EXPECT_EQ(tracking[0].ratio_median, 0.5);
  EXPECT_EQ(tracking[0].ratio_p95, 3);
  results.rows.erase(results.rows.begin() + 3);
  EXPECT_NEAR(summary_of(results).detectors.at(0).tracking[0].with_rad,
              std::sqrt((0.25 + 0.0625 + 9) / 3), 1e-12);
}

}  // namespace
}  // namespace offnominal::desk::campaign
