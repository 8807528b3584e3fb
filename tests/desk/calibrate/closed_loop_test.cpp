// The loop that the product is about, on the paper's arm: a recording of the healthy arm names what
// the model lacks, the better model allows a tighter bound, and the tighter bound shows a smaller
// fault. The plant is the simulator's own, with friction and disturbance as the paper has them.

#include <gtest/gtest.h>

#include <optional>

#include "calibrate/calibrate.hpp"
#include "identify/add.hpp"
#include "paper/experiment.hpp"
#include "paper/recording.hpp"
#include "paper/sweep.hpp"
#include "paper/two_link_robot.hpp"
#include "support/repetitions.hpp"

namespace offnominal::desk {
namespace {

using paper::Experiment;

constexpr double kLongestRun = 100;  // s

Log healthy_recording(const RobotDescription& robot, double start_s, double duration_s) {
  Experiment experiment;
  experiment.duration_s = duration_s;
  experiment.motion_start_s = start_s;
  experiment.record = true;
  Log log = paper::recording_of(robot, experiment, paper::run_experiment(robot, experiment));
  log.file = "from " + std::to_string(start_s) + " s";
  return log;
}

RobotDescription with_effects(const RobotDescription& robot, const std::vector<EffectKind>& effects,
                              std::size_t joint, const Log& log) {
  AddRequest request;
  request.effects = effects;
  request.joint = joint;
  request.fit_skew = false;  // the monitor will have the recording's
  // The monitor sees what is faster than the usual filter lets pass.
  const AddResult result = add(robot, request, {log}, {}, {.cutoff_hz = 100, .decimate = {}});
  EXPECT_TRUE(result.objections.empty()) << result.objections.front();
  return result.robot;
}

// The motion repeats every 2 pi s, and so does the disturbance: what one recording teaches is one
// phase between the two, however long it is. Hence many short ones; and some as long as the monitor
// will run, since what little the disturbance's frequency is off adds up.
Calibration calibrated(const RobotDescription& robot) {
  constexpr int kPhases = test::repetitions(20) == 20 ? 20 : 6;
  std::vector<Log> logs;
  for (int i = 1; i <= kPhases; ++i) {
    logs.push_back(healthy_recording(robot, 6.2 * i / kPhases, i % 5 == 0 ? kLongestRun : 15));
  }
  return calibrate(robot, {}, logs, {healthy_recording(robot, 11.13, 60)});
}

struct Chain {
  RobotDescription nominal = paper::two_link_robot();
  RobotDescription improved;
  std::optional<Calibration> recalibrated;  // nominal model
  std::optional<Calibration> final;         // improved model
};

const Chain& chain() {
  static const Chain all = [] {
    Chain made;
    // Long enough for the disturbance's frequency: its phase must not drift away over a run.
    const Log log = healthy_recording(made.nominal, 0, 120);
    made.improved = with_effects(made.nominal,
                                 {EffectKind::kViscousFriction, EffectKind::kCoulombFriction,
                                  EffectKind::kPeriodicDisturbance},
                                 0, log);
    made.improved = with_effects(
        made.improved, {EffectKind::kViscousFriction, EffectKind::kPeriodicDisturbance}, 1, log);
    made.recalibrated = calibrated(made.nominal);
    made.final = calibrated(made.improved);
    return made;
  }();
  return all;
}

bool sees(const RobotDescription& robot, double mass_loss) {
  Experiment experiment;
  experiment.fault.kind = sim::FaultKind::kMassLoss;
  experiment.fault.mass_loss = mass_loss;
  const paper::ExperimentResult run = paper::run_experiment(robot, experiment);
  if (!run.detection_time_s) return false;
  EXPECT_GT(*run.detection_time_s, *run.fault_time_s) << "a false alarm detects nothing";
  return *run.detection_time_s > *run.fault_time_s;
}

TEST(ClosingTheLoop, ThePapersModelAndBoundSeeTenPercentOfMassLossAndNotFive) {
  EXPECT_TRUE(sees(chain().nominal, 0.10));
  EXPECT_FALSE(sees(chain().nominal, 0.05));
}

TEST(ClosingTheLoop, TheImprovedModelWithItsBoundSeesTwoPercent) {
  ASSERT_TRUE(chain().final->objections.empty()) << chain().final->objections.front();
  EXPECT_TRUE(sees(chain().final->robot, 0.02));
}

TEST(ClosingTheLoop, ItIsTheModelThatDoesItNotTheBoundAlone) {
  ASSERT_TRUE(chain().recalibrated->objections.empty());
  EXPECT_FALSE(sees(chain().recalibrated->robot, 0.02));
  EXPECT_FALSE(sees(chain().improved, 0.05)) << "the old bound hides it from the better model";
}

TEST(ClosingTheLoop, NoSmallerBoundIsBoughtWithFalseAlarms) {
  const RobotDescription& robot = chain().final->robot;
  for (int i = 0; i < test::repetitions(20); ++i) {
    Experiment experiment;
    experiment.motion_start_s = 0.3142 * i + 0.03;  // phases that were not recorded
    experiment.duration_s = 20 + 4 * i;
    RobotDescription other = robot;
    other.estimator.seed = static_cast<std::uint32_t>(i + 2);
    const paper::ExperimentResult run = paper::run_experiment(other, experiment);
    EXPECT_FALSE(run.detection_time_s)
        << "start " << experiment.motion_start_s << " s, up to "
        << run.max_error_to_threshold_before_fault << " of the threshold";
    EXPECT_GT(run.max_error_to_threshold_before_fault, 0.1) << "the threshold must be felt";
  }
}

}  // namespace
}  // namespace offnominal::desk
