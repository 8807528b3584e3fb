#include "wcet/tick.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>

#include "common/error.hpp"
#include "paper/two_link_robot.hpp"
#include "wcet/campaign.hpp"
#include "wcet/cyclic.hpp"

namespace offnominal::desk::wcet {
namespace {

using testing::HasSubstr;

TickInput adapting(const RobotDescription& robot) {
  return scenarios(robot, Precision::kFloat).at(1).input;
}

TEST(Tick, BeginsEveryTimeFromTheSameState) {
  const RobotDescription robot = paper::two_link_robot();
  const auto tick = make_tick(robot, Precision::kFloat, hal::FrameFormat::kClassic);
  tick->prepare(adapting(robot));
  const TickFacts first = tick->facts();
  for (int i = 0; i < 20; ++i) {
    tick->restore();
    tick->run();
  }
  const TickFacts again = tick->facts();
  EXPECT_EQ(first.weight_norm, again.weight_norm);
  EXPECT_EQ(first.error_to_threshold, again.error_to_threshold);
  EXPECT_EQ(first.frames, again.frames);
}

TEST(Tick, HasTimeInEveryPhaseAndPart) {
  const RobotDescription robot = paper::two_link_robot();
  for (const auto format : {hal::FrameFormat::kClassic, hal::FrameFormat::kFd}) {
    const auto tick = make_tick(robot, Precision::kDouble, format);
    tick->prepare(adapting(robot));
    std::array<std::int64_t, kPhases> durations{};
    tick->restore();
    tick->run_phases(durations);
    for (const std::int64_t duration : durations) EXPECT_GT(duration, 0);
    tick->restore();
    tick->run_part(Part::kModel);
    tick->run_part(Part::kEstimator);
    EXPECT_EQ(tick->facts().frames, format == hal::FrameFormat::kFd ? 2U : 4U);
  }
}

// The paper's arm with its monitor in torque space.
RobotDescription by_joint() {
  RobotDescription robot = paper::two_link_robot();
  robot.estimator.space = EstimatorSpace::kTorque;
  robot.bound = BoundSettings{};
  robot.bound->kind = BoundSettings::Kind::kPerJoint;
  robot.bound->joints.resize(2);
  return robot;
}

TEST(Tick, InTorqueSpaceIsWhatEveryScenarioAsksFor) {
  const RobotDescription robot = by_joint();
  for (const Precision precision : {Precision::kFloat, Precision::kDouble}) {
    const auto tick = make_tick(robot, precision, hal::FrameFormat::kClassic);
    for (const Scenario& scenario : scenarios(robot, precision)) {
      tick->prepare(scenario.input);
      const TickFacts facts = tick->facts();
      EXPECT_TRUE(facts.watched) << scenario.name;
      EXPECT_EQ(facts.learned, scenario.input.error_to_threshold > 1) << scenario.name;
      EXPECT_NEAR(facts.error_to_threshold / scenario.input.error_to_threshold, 1, 1e-3)
          << scenario.name;
      EXPECT_EQ(facts.began_on_ball, scenario.input.on_ball) << scenario.name;
      EXPECT_TRUE(facts.gradient_outwards || !scenario.input.on_ball) << scenario.name;
      tick->restore();
      tick->run_part(Part::kModel);
      tick->run_part(Part::kEstimator);
    }
  }
}

std::string refusal_of(const RobotDescription& robot) {
  try {
    static_cast<void>(make_tick(robot, Precision::kFloat, hal::FrameFormat::kClassic));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Tick, RefusesARobotThatThisBuildHasNoControllerFor) {
  RobotDescription robot = paper::two_link_robot();
  robot.estimator.hidden_units = 200;
  EXPECT_THAT(refusal_of(robot), HasSubstr("found 2x200; allowed: at most what this build has: "));
  robot = paper::two_link_robot();
  robot.bound.reset();
  EXPECT_THAT(refusal_of(robot), HasSubstr("uncertainty_bound: found nothing"));
}

TEST(Campaign, MeasuresWhatItWasAskedFor) {
  const RobotDescription robot = paper::two_link_robot();
  WcetSettings settings;
  settings.ticks = 2000;
  settings.cold_ticks = 3;
  settings.search.evaluations = 20;
  settings.machine.lock_memory = false;
  const WcetResult result = measure_wcet(robot, settings, {});
  EXPECT_EQ(result.worst.histogram.count(), 2000U);
  EXPECT_EQ(result.cold.histogram.count(), 3U);
  EXPECT_EQ(result.scenarios.size(), scenarios(robot, Precision::kFloat).size());
  EXPECT_EQ(result.phases.size(), kPhases + kParts);
  EXPECT_EQ(result.extrapolation.block_size, 2);
  EXPECT_EQ(result.extrapolation.blocks, 1000U);
  EXPECT_TRUE(result.worst_facts.watched);
  EXPECT_EQ(result.hidden_units, 35);
  EXPECT_GE(result.hidden_capacity, 35);
}

TEST(Campaign, CountsTicksThatOutlastThePeriod) {
  const RobotDescription robot = paper::two_link_robot();
  WcetSettings settings;
  settings.ticks = 100;
  settings.cold_ticks = 1;
  settings.search.evaluations = 0;
  settings.period_s = 1e-9;  // shorter than any tick
  settings.machine.lock_memory = false;
  EXPECT_EQ(measure_wcet(robot, settings, {}).worst.overruns, 100U);
  settings.period_s = 1000;
  EXPECT_EQ(measure_wcet(robot, settings, {}).worst.overruns, 0U);
}

TEST(Cyclic, WakesAsOftenAsItWasAskedTo) {
  int ran = 0;
  int between = 0;
  const CyclicResult result = run_cyclic(
      {.interval_us = 100, .ticks = 20, .request = {}, .machine = {}}, [&] { ++ran; },
      [&] { ++between; });
  EXPECT_EQ(ran, 20);
  EXPECT_EQ(between, 20);
  EXPECT_EQ(result.latency.count(), 20U);
  EXPECT_GE(result.response.max_ns(), result.latency.max_ns());
}

}  // namespace
}  // namespace offnominal::desk::wcet
