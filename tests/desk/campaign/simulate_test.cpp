#include "campaign/simulate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "campaign/momentum_observer.hpp"
#include "desk/campaign/small_campaign.hpp"
#include "log/observed_motion.hpp"

namespace offnominal::desk::campaign {
namespace {

using test::campaign_of;
using test::small_campaign;

const std::string kAllFaults =
    "[[fault]]\nkind = \"payload\"\nsizes = [1.0]\n"
    "[[fault]]\nkind = \"friction\"\njoint = 2\nsizes = [4.0]\n"
    "[[fault]]\nkind = \"torque_lost\"\njoint = 1\nsizes = [0.5]\n"
    "[[fault]]\nkind = \"encoder_stuck\"\njoint = 1\n"
    "[[fault]]\nkind = \"encoder_jump\"\njoint = 2\nsizes = [0.1]\n"
    "[[fault]]\nkind = \"locked\"\njoint = 2\n";

Campaign without_errors(const std::string& kind) {
  Campaign campaign = campaign_of(small_campaign(kAllFaults, kind));
  campaign.model.joints = campaign.truth.joints;
  campaign.plant.torque_noise = 0;
  campaign.plant.encoder_bits = 0;
  campaign.plant.velocity = VelocityKind::kSent;
  return campaign;
}

// Largest torque that the model does not know, N m, from begin_s to end_s.
double unknown_nm(const Campaign& campaign, const Log& log, double begin_s, double end_s) {
  const Eigen::MatrixXd residual = momentum_residual(campaign.model, 30, log);
  double largest = 0;
  for (Eigen::Index row = 0; row < residual.rows(); ++row) {
    if (log.t_s[row] < begin_s || log.t_s[row] >= end_s) continue;
    largest = std::max(largest, residual.row(row).cwiseAbs().maxCoeff());
  }
  return largest;
}

class SimulatedRun : public testing::TestWithParam<const char*> {};

TEST_P(SimulatedRun, ShowsNothingOfAHealthyRobotAndEveryFaultFromItsBeginningOn) {
  const Campaign campaign = without_errors(GetParam());
  const Simulator simulator(campaign);
  for (const Fault& fault : campaign.faults) {
    if (fault.kind == FaultKind::kOffset && fault.size < 1) continue;
    const RecordedRun run = simulator.run({3, &fault, campaign.runs.duration_s});
    const double fault_s = campaign.runs.fault_s;
    EXPECT_LT(unknown_nm(campaign, run.log, 0, fault_s), 0.1) << info_of(fault.kind).name;
    EXPECT_GT(unknown_nm(campaign, run.log, fault_s, campaign.runs.duration_s), 1)
        << info_of(fault.kind).name << " of joint " << fault.joint + 1;
    EXPECT_LT(run.tracking_before_rad.value_or(1), 0.01);
  }
}

INSTANTIATE_TEST_SUITE_P(Plants, SimulatedRun, testing::Values("robot", "mujoco"),
                         [](const auto& instance) { return std::string(instance.param); });

TEST(Simulator, MakesARunOfItsNumberAlone) {
  const Campaign campaign = campaign_of(small_campaign());
  const Log first = Simulator(campaign).run(run_of(campaign, 5)).log;
  const Simulator other(campaign);
  static_cast<void>(other.run(run_of(campaign, 1)));
  const Log again = other.run(run_of(campaign, 5)).log;
  EXPECT_EQ(first.q, again.q);
  EXPECT_EQ(first.dq, again.dq);
  EXPECT_EQ(first.tau, again.tau);
  EXPECT_NE(first.q, other.run(run_of(campaign, 4)).log.q);
}

TEST(Simulator, RecordsAsLongAsTheRunIsWhateverItsVelocitiesAre) {
  Campaign campaign = campaign_of(small_campaign());
  for (const VelocityKind kind :
       {VelocityKind::kDerived, VelocityKind::kObserved, VelocityKind::kSent}) {
    campaign.plant.velocity = kind;
    const Log log = Simulator(campaign).run(run_of(campaign, 0)).log;
    const Eigen::Index unsettled =
        kind == VelocityKind::kObserved ? MotionObserver(1, log.period_s).ticks_to_settle() : 0;
    EXPECT_EQ(log.sample_count(), 750 - unsettled);
    EXPECT_EQ(log.dq.rows(), 750 - unsettled);
    EXPECT_EQ(log.readings.rows() > 0, kind == VelocityKind::kObserved);
  }
}

// GIVEN a model without an error and ideal encoders WHEN velocities are observed THEN a healthy
// robot shows hardly more than where they are sent, though the observer is a hundredth of a second
// late.
TEST(Simulator, ObservesVelocitiesWithoutALag) {
  Campaign campaign = without_errors("mujoco");
  const double sent = unknown_nm(campaign, Simulator(campaign).run(run_of(campaign, 3)).log, 0.1,
                                 campaign.runs.fault_s);
  campaign.plant.velocity = VelocityKind::kObserved;
  const double observed = unknown_nm(campaign, Simulator(campaign).run(run_of(campaign, 3)).log,
                                     0.1, campaign.runs.fault_s);
  EXPECT_LT(observed, sent + 0.05);
}

TEST(Simulator, SaysWhenTheJointAtFaultIsToMove) {
  const Campaign campaign = without_errors("robot");
  const Simulator simulator(campaign);
  bool one_stands = false;
  for (int number = 0; number < 60 && !one_stands; ++number) {
    for (const Fault& fault : campaign.faults) {
      const RecordedRun run = simulator.run({number, &fault, campaign.runs.duration_s});
      if (fault.kind == FaultKind::kPayload) {
        EXPECT_FALSE(run.moves_after_s);
        continue;
      }
      const bool of_drive =
          fault.kind == FaultKind::kFriction || fault.kind == FaultKind::kTorqueLost;
      if (!of_drive || !run.moves_after_s) continue;
      const double at_s = campaign.runs.fault_s + *run.moves_after_s;
      double fastest = 0;
      double stands_at = 0;
      for (Eigen::Index row = 0; row < run.log.sample_count(); ++row) {
        const double speed = std::abs(run.log.dq(row, fault.joint));
        if (run.log.t_s[row] < campaign.runs.fault_s) fastest = std::max(fastest, speed);
        const bool between = run.log.t_s[row] >= campaign.runs.fault_s && run.log.t_s[row] < at_s;
        if (between) stands_at = std::max(stands_at, speed);
      }
      EXPECT_LT(stands_at, fastest / 20) << number << ": it follows what is wanted";
      one_stands = one_stands || *run.moves_after_s > 0;
    }
  }
  EXPECT_TRUE(one_stands);
}

// A monitor in the loop of the two-link arm, whose bounds the healthy runs keep.
RobotDescription watching(const Campaign& campaign) {
  RobotDescription robot = campaign.model;
  robot.estimator.space = EstimatorSpace::kTorque;
  robot.estimator.learning_rate = 50;
  robot.bound = BoundSettings{};
  robot.bound->kind = BoundSettings::Kind::kPerJoint;
  robot.bound->joints = {{.at = {}, .value = {0.5}}, {.at = {}, .value = {0.5}}};
  return robot;
}

Campaign long_runs(const std::string& kind) {
  Campaign campaign = without_errors(kind);
  campaign.runs = {.per_fault = 1, .duration_s = 8, .fault_s = 2};
  return campaign;
}

const Fault& fault_of(const Campaign& campaign, FaultKind kind) {
  return *std::find_if(campaign.faults.begin(), campaign.faults.end(),
                       [kind](const Fault& fault) { return fault.kind == kind; });
}

TEST(Accommodated, IsTheSameRunUntilItIsDecidedAndThenFollowsBetter) {
  const Campaign campaign = long_runs("mujoco");
  const Simulator simulator(campaign);
  const campaign::Run run{3, &fault_of(campaign, FaultKind::kPayload), campaign.runs.duration_s};
  const RecordedRun without = simulator.run(run);
  Accommodation loop(watching(campaign), campaign.plant.period_s);
  const RecordedRun with = simulator.accommodated(run, without, loop);
  const auto differs = (without.log.q - with.log.q).rowwise().norm().array() > 0;
  Eigen::Index first = 0;
  ASSERT_GT(differs.maxCoeff(&first), 0);
  EXPECT_GT(without.log.t_s[first], campaign.runs.fault_s + 0.3);
  ASSERT_TRUE(with.tracking_end_rad && without.tracking_end_rad);
  EXPECT_LT(*with.tracking_end_rad, 0.5 * *without.tracking_end_rad);
}

TEST(Accommodated, OfAnEncoderThatJumpsChangesNothing) {
  const Campaign campaign = long_runs("mujoco");
  const Simulator simulator(campaign);
  const campaign::Run run{3, &fault_of(campaign, FaultKind::kEncoderJump),
                          campaign.runs.duration_s};
  const RecordedRun without = simulator.run(run);
  Accommodation loop(watching(campaign), campaign.plant.period_s);
  const RecordedRun with = simulator.accommodated(run, without, loop);
  ASSERT_TRUE(loop.answer());
  EXPECT_EQ(loop.answer()->kind, offnominal::FaultKind::kEncoderJump)
      << name_of(loop.answer()->kind);
  EXPECT_EQ(without.log.q, with.log.q);
  EXPECT_EQ(without.log.tau, with.log.tau);
}

}  // namespace
}  // namespace offnominal::desk::campaign
