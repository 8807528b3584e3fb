#include "tune/tune.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "calibrate/calibrate_joints.hpp"
#include "common/error.hpp"
#include "desk/compare/recorded_arm.hpp"
#include "replay/replay.hpp"
#include "robot/robot_file.hpp"
#include "tune/learning_trials.hpp"

// Settings of the monitor from recordings of an arm whose friction its model has a little wrong.

namespace offnominal::desk {
namespace {

using test::ArmInstant;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Log run_of(std::uint64_t seed, double fault_nm = 0, double duration_s = 20) {
  Log log = test::record_arm(
      {.duration_s = duration_s, .rate_hz = 100, .torque_noise = 0.02, .seed = seed},
      [fault_nm, seed](const ArmInstant& at) -> Eigen::Vector2d {
        const double wave = std::sin(at.t_s * (1 + 0.1 * static_cast<double>(seed)));
        return {0.2 * std::tanh(20 * at.dq[0]) + 0.1 * wave - (at.t_s > 10 ? fault_nm : 0),
                0.1 * std::tanh(20 * at.dq[1])};
      });
  log.file = "run " + std::to_string(seed);
  return log;
}

class Tuning : public testing::Test {
 protected:
  static const Tuned& tuned() {
    static const Tuned result =
        tune(test::arm_description(), {}, {run_of(1), run_of(2)}, {run_of(3)});
    return result;
  }
  static const EstimatorLine& line_of(const std::string& key) {
    return *std::find_if(tuned().lines.begin(), tuned().lines.end(),
                         [&](const EstimatorLine& line) { return line.key == key; });
  }
};

TEST_F(Tuning, TakesAPoleThatSeesNearlyAsLittleAsTheBest) {
  double best = 1e9;
  const AlphaTrial* chosen = nullptr;
  for (const AlphaTrial& trial : tuned().alphas) {
    if (trial.alpha_per_s * 0.01 > 0.3) {
      EXPECT_THAT(trial.why_none, HasSubstr("too fast for a tick of 0.01 s"));
      continue;
    }
    if (!trial.why_none.empty()) continue;
    ASSERT_EQ(trial.seen_from.size(), 2U);
    EXPECT_NEAR(trial.mean, std::sqrt(trial.seen_from[0] * trial.seen_from[1]), 1e-9);
    best = std::min(best, trial.mean);
    if (trial.chosen) chosen = &trial;
  }
  ASSERT_NE(chosen, nullptr);
  EXPECT_LE(chosen->mean, 1.2 * best);
  EXPECT_EQ(tuned().robot.estimator.alpha, chosen->alpha_per_s);
}

TEST_F(Tuning, LearnsNoWorseThanWithTheSettingsBefore) {
  const auto chosen = [](const LearningTrial& trial) { return trial.chosen; };
  ASSERT_EQ(std::count_if(tuned().rates.begin(), tuned().rates.end(), chosen), 1);
  ASSERT_EQ(std::count_if(tuned().sizes.begin(), tuned().sizes.end(), chosen), 1);
  const LearningTrial& size = *std::find_if(tuned().sizes.begin(), tuned().sizes.end(), chosen);
  for (const LearningTrial& trial : tuned().sizes) EXPECT_LT(size.missed, trial.missed + 0.021);
  const LearningTrial& taken = tuned().before.chosen ? tuned().before : size;
  EXPECT_LE(taken.missed, std::min(tuned().before.missed, size.missed) + 0.021);
  EXPECT_LT(taken.missed, 0.5);
  EXPECT_EQ(tuned().robot.estimator.hidden_units, taken.hidden_units);
  EXPECT_EQ(tuned().robot.estimator.learning_rate, taken.learning_rate);
  EXPECT_EQ(tuned().robot.estimator.initial_weight_range, taken.initial_weight_range);
}

TEST_F(Tuning, SaysWhyBehindEachSetting) {
  for (const char* key : {"space", "isolation", "alpha_per_s", "hidden_units", "learning_rate",
                          "weight_radius", "initial_weight_range"}) {
    EXPECT_FALSE(line_of(key).reason.empty()) << key;
  }
  EXPECT_EQ(line_of("space").value, "\"torque\"");
  EXPECT_EQ(line_of("isolation").value, "true");
  EXPECT_TRUE(tuned().robot.estimator.isolation);
  const std::string text = text_of(tuned(), {});
  EXPECT_THAT(text, HasSubstr("alpha_per_s = " + line_of("alpha_per_s").value));
  EXPECT_THAT(text, HasSubstr("seen within 0.2 s"));
}

// What the verb promises: tune, calibrate, replay, and nothing by hand.
TEST_F(Tuning, WithItsBoundSeesAFaultOfTheSizeThatItSaysAndLearnsIt) {
  EXPECT_FALSE(tuned().robot.bound);
  const JointsCalibration calibrated =
      calibrate_joints(tuned().robot, {}, {run_of(1), run_of(2)}, {run_of(3)});
  EXPECT_THAT(calibrated.objections, IsEmpty());
  EXPECT_THAT(replay(calibrated.robot, run_of(4)).alarms, IsEmpty());
  const double fault = 8 * calibrated.joints[0].fault.usual;
  const Replay run = replay(calibrated.robot, run_of(5, fault));
  ASSERT_TRUE(run.detection_time_s);
  EXPECT_EQ(run.first_joint, 0);
  EXPECT_NEAR(*run.detection_time_s, 10.2, 0.2);
  EXPECT_LT(run.max_weight_norm, 0.999 * tuned().robot.estimator.weight_radius);
  double learnt = 0;
  const Eigen::Index last = run.psi_hat.rows() - 1;
  for (Eigen::Index row = last - 399; row <= last; ++row) learnt += run.psi_hat(row, 0) / 400;
  EXPECT_GT(learnt, 0.5 * fault) << "but for the dead zone";
  EXPECT_LT(learnt, 1.3 * fault);
}

TEST_F(Tuning, OfTheSameRecordingsIsTheSame) {
  const Tuned again = tune(test::arm_description(), {}, {run_of(1), run_of(2)}, {run_of(3)});
  EXPECT_EQ(text_of(again, {}), text_of(tuned(), {}));
}

TEST(LearningTrials, ANetworkThatLearnsNothingMissesAll) {
  RobotDescription robot = test::arm_description();
  robot.estimator.space = EstimatorSpace::kTorque;
  BoundSettings& bound = robot.bound.emplace();
  bound.kind = BoundSettings::Kind::kPerJoint;
  bound.joints.resize(2);
  for (JointBoundSettings& joint : bound.joints) joint.value = {0.5};
  const LearningTrials trials(robot, {run_of(1)}, {Eigen::Vector2d(5, 5), Eigen::Vector2d(9, 9)},
                              {});
  EXPECT_NEAR(trials.seconds(), 12, 0.1);
  EstimatorSettings settings = robot.estimator;
  settings.learning_rate = 0;
  EXPECT_NEAR(trials.run(settings).missed, 1, 1e-12);
  settings.learning_rate = 20;
  EXPECT_LT(trials.run(settings).missed, 0.8);
}

TEST(Tune, OfARecordingThatIsTooShortSaysSo) {
  EXPECT_THROW(static_cast<void>(tune(test::arm_description(), {}, {run_of(1, 0, 1)}, {})),
               InputError);
}

}  // namespace
}  // namespace offnominal::desk
