#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/error.hpp"
#include "paper/recording.hpp"
#include "paper/two_link_robot.hpp"
#include "sil/sil.hpp"
#include "sil/sil_report.hpp"

namespace offnominal::desk::sil {
namespace {

using controller::Fault;
using sim::FaultEvent;
using sim::FaultEventKind;

Scenario scenario_with(std::vector<FaultEvent> faults, double duration_s = 4.0) {
  Scenario scenario;
  scenario.faults = std::move(faults);
  scenario.duration_s = duration_s;
  return scenario;
}

SilResult run(const Scenario& scenario) {
  const auto wire = make_in_process_wire();
  return run_in_lock_step(paper::two_link_robot(), scenario, *wire, kInProcess);
}

SilResult run_with(FaultEvent fault) {
  fault.begin_s = 2.0;
  return run(scenario_with({fault}));
}

TEST(LockStep, OverTheBusIsThePaperRunButForWhatFramesResolve) {
  Scenario scenario = scenario_with(
      {{.kind = FaultEventKind::kMassLoss, .begin_s = 10.0, .size = 0.75, .rate_per_s = 0.5}},
      20.0);
  paper::Experiment experiment;
  experiment.fault.kind = sim::FaultKind::kMassLoss;
  for (const bool accommodate : {false, true}) {
    scenario.accommodate = accommodate;
    experiment.accommodate = accommodate;
    const SilResult over_bus = run(scenario);
    const auto alone = run_experiment(paper::two_link_robot(), experiment);
    ASSERT_TRUE(over_bus.run.detection_time_s.has_value());
    EXPECT_NEAR(*over_bus.run.detection_time_s, *alone.detection_time_s, 0.1);
    EXPECT_NEAR(over_bus.run.tracking_rms_rad, alone.tracking_rms_rad,
                0.02 * alone.tracking_rms_rad);
    EXPECT_LT(over_bus.run.max_error_to_threshold_before_fault, 1.0);
    EXPECT_EQ(over_bus.bus.rejected, 0U);
    EXPECT_EQ(over_bus.bus.stale, 0U);
    EXPECT_FALSE(over_bus.time_to_safe_state_s.has_value());
  }
}

TEST(LockStep, TheSameScenarioGivesTheSameBytes) {
  const Scenario scenario =
      scenario_with({{.kind = FaultEventKind::kFrameLoss, .begin_s = 2.0, .size = 0.05}});
  const std::string first = to_json(run(scenario)).dump();
  EXPECT_EQ(to_json(run(scenario)).dump(), first);
  Scenario other = scenario;
  other.faults[0].begin_s = 1.0;
  other.seed = 2;
  EXPECT_NE(to_json(run(other)).dump(), first);
}

// Faults that the arm's motion shows: the monitor has to see them, the controller goes on.
TEST(LockStep, SeesWhatChangesTheMotion) {
  for (const FaultEvent fault :
       {FaultEvent{.kind = FaultEventKind::kPayload, .size = 1.0},
        FaultEvent{.kind = FaultEventKind::kFrictionJump, .joint = 1, .size = 15.0},
        FaultEvent{.kind = FaultEventKind::kTorqueLoss, .joint = 0, .size = 0.4},
        FaultEvent{.kind = FaultEventKind::kEncoderStuck, .joint = 0}}) {
    const SilResult result = run_with(fault);
    EXPECT_TRUE(result.run.detection_time_s.has_value()) << info_of(fault.kind).name;
    EXPECT_EQ(result.fault, Fault::kNone) << info_of(fault.kind).name;
  }
}

// The recording of a run is what the controller saw, and beside it what was true.
TEST(LockStep, RecordsWhatTheControllerSawAndTheTruthBesideIt) {
  const auto recording_with = [](const std::vector<FaultEvent>& faults, bool accommodate = false) {
    Scenario scenario = scenario_with(faults);
    scenario.accommodate = accommodate;
    scenario.record = true;
    const RobotDescription robot = paper::two_link_robot();
    const auto wire = make_in_process_wire();
    const SilResult result = run_in_lock_step(robot, scenario, *wire, kInProcess);
    return paper::seen_recording_of(robot, result.run.series);
  };
  const auto tail = [](const Log& log, const Eigen::VectorXd& column) {
    return column.tail(log.sample_count() / 4).eval();
  };
  const Log stuck =
      recording_with({{.kind = FaultEventKind::kEncoderStuck, .begin_s = 2.0, .joint = 0}});
  const Eigen::VectorXd q1 = tail(stuck, stuck.q.col(0));
  EXPECT_EQ(q1.maxCoeff(), q1.minCoeff());
  const Eigen::VectorXd truth = tail(stuck, stuck.extra.at("q_true1"));
  EXPECT_GT(truth.maxCoeff() - truth.minCoeff(), 0.01);
  EXPECT_LT((tail(stuck, stuck.q.col(1)) - tail(stuck, stuck.extra.at("q_true2"))).norm(), 1e-3);

  const Log weak = recording_with(
      {{.kind = FaultEventKind::kTorqueLoss, .begin_s = 2.0, .joint = 1, .size = 0.4}}, true);
  EXPECT_LT((0.6 * tail(weak, weak.tau.col(1)) - tail(weak, weak.extra.at("tau_true2"))).norm(),
            1e-3);
  const Eigen::VectorXd& compensation = weak.extra.at("compensation2");
  EXPECT_EQ(compensation.head(weak.sample_count() / 10).norm(), 0) << "before the fault";
  EXPECT_GT(tail(weak, compensation).cwiseAbs().maxCoeff(), 0.1) << "N m";

  // A tick without a reading is no row.
  const Log lossy =
      recording_with({{.kind = FaultEventKind::kFrameLoss, .begin_s = 0.5, .size = 0.01}});
  const Log whole = recording_with({});
  EXPECT_LT(lossy.sample_count(), whole.sample_count());
  EXPECT_GT(lossy.sample_count(), 0.9 * static_cast<double>(whole.sample_count()));
}

// GIVEN faults after which nothing can be trusted THEN no drive gives torque after a few ticks.
TEST(LockStep, IsSafeSoonWhereReadingsOrTheBusFail) {
  const auto expect_safe = [](const FaultEvent& fault, Fault why, double within_s) {
    const SilResult result = run_with(fault);
    EXPECT_EQ(result.fault, why) << info_of(fault.kind).name;
    ASSERT_TRUE(result.time_to_safe_state_s.has_value()) << info_of(fault.kind).name;
    EXPECT_LE(*result.time_to_safe_state_s, within_s) << info_of(fault.kind).name;
    EXPECT_TRUE(result.ended_early_s.has_value());
  };
  expect_safe({.kind = FaultEventKind::kEncoderDropout, .joint = 0}, Fault::kDriveReported, 0.003);
  expect_safe({.kind = FaultEventKind::kSilentNode, .joint = 1}, Fault::kEncoderSilent, 0.007);
  expect_safe({.kind = FaultEventKind::kBlockedBus}, Fault::kEncoderSilent, 0.008);
  expect_safe({.kind = FaultEventKind::kBusOff}, Fault::kBusLost, 0.008);
  expect_safe({.kind = FaultEventKind::kReplayedBurst, .size = 8}, Fault::kEncoderUntrusted, 0.005);
}

// Faults that a bus has every day: the controller bears them.
TEST(LockStep, BearsFramesThatAreLostTwiceOrLate) {
  for (const FaultEvent fault : {FaultEvent{.kind = FaultEventKind::kFrameLoss, .size = 0.01},
                                 FaultEvent{.kind = FaultEventKind::kDuplicateFrames, .size = 0.5},
                                 FaultEvent{.kind = FaultEventKind::kReorderedFrames, .size = 0.1},
                                 FaultEvent{.kind = FaultEventKind::kBabblingNode, .size = 20}}) {
    const SilResult result = run_with(fault);
    EXPECT_EQ(result.state, hal::ControllerState::kArmed) << info_of(fault.kind).name;
    EXPECT_FALSE(result.run.detection_time_s.has_value()) << info_of(fault.kind).name;
  }
}

// GIVEN drives that send positions alone WHEN the run begins THEN nothing is detected, and the
// torque does not swing, while the observer finds what the arm does.
TEST(LockStep, ObservedVelocitiesBringNoAlarm) {
  Scenario scenario = scenario_with({});
  scenario.sends_velocity = false;
  const SilResult result = run(scenario);
  EXPECT_FALSE(result.run.detection_time_s.has_value());
  EXPECT_LT(result.run.max_error_to_threshold_before_fault, 0.9);
  EXPECT_EQ(result.state, hal::ControllerState::kArmed);
}

TEST(LockStep, AcceptsNothingThatIsForged) {
  Scenario scenario =
      scenario_with({{.kind = FaultEventKind::kForgedFrames, .begin_s = 2.0, .size = 2}});
  const SilResult result = run(scenario);
  EXPECT_GT(result.bus.rejected, 100U);
  // What was taken came from the plant: the arm was where it should be until the controller let go.
  EXPECT_FALSE(result.run.detection_time_s.has_value());
}

TEST(LockStep, AFaultThatCannotBeIsRefused) {
  EXPECT_THROW(run(scenario_with({{.kind = FaultEventKind::kFrameLoss, .size = 1.5}})), InputError);
  EXPECT_THROW(run(scenario_with({{.kind = FaultEventKind::kEncoderStuck, .joint = 2}})),
               InputError);
  EXPECT_THROW(run(scenario_with({{.kind = FaultEventKind::kBusOff, .begin_s = 5.0}})), InputError);
  EXPECT_THROW(run(scenario_with({{.kind = FaultEventKind::kMassLoss, .begin_s = 1, .size = 0.5},
                                  {.kind = FaultEventKind::kNonlinear, .begin_s = 1}})),
               InputError);
}

TEST(LockStep, ClassicAndFdFramesGiveTheSameRun) {
  Scenario scenario = scenario_with({{.kind = FaultEventKind::kPayload, .begin_s = 2, .size = 1}});
  const SilResult classic = run(scenario);
  scenario.format = hal::FrameFormat::kFd;
  const SilResult fd = run(scenario);
  EXPECT_EQ(classic.run.detection_time_s, fd.run.detection_time_s);
  EXPECT_EQ(classic.run.tracking_rms_rad, fd.run.tracking_rms_rad);
  EXPECT_LT(fd.bus.load, classic.bus.load);
}

}  // namespace
}  // namespace offnominal::desk::sil
