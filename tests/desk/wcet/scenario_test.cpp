#include "wcet/scenario.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>
#include <string>

#include "paper/two_link_robot.hpp"
#include "support/seed.hpp"

// That a scenario is what its name says is asked of the controller, not of the scenario.

namespace offnominal::desk::wcet {
namespace {

class EveryPrecision : public testing::TestWithParam<Precision> {
 protected:
  std::map<std::string, TickFacts> all_facts() {
    std::map<std::string, TickFacts> facts;
    for (const Scenario& scenario : scenarios(robot_, GetParam())) {
      tick_->prepare(scenario.input);
      facts[scenario.name] = tick_->facts();
    }
    return facts;
  }

  RobotDescription robot_ = paper::two_link_robot();
  std::unique_ptr<Tick> tick_ = make_tick(robot_, GetParam(), hal::FrameFormat::kClassic);
};

INSTANTIATE_TEST_SUITE_P(Scenario, EveryPrecision,
                         testing::Values(Precision::kFloat, Precision::kDouble));

TEST_P(EveryPrecision, ScenariosReachTheMonitor) {
  for (const auto& [name, facts] : all_facts()) {
    EXPECT_TRUE(facts.watched) << name;
    EXPECT_LE(facts.weight_norm, facts.weight_radius) << name;
  }
}

TEST_P(EveryPrecision, HealthyLearnsNothingAndAdaptingDoes) {
  const auto facts = all_facts();
  EXPECT_FALSE(facts.at("healthy").learned);
  EXPECT_LT(facts.at("healthy").error_to_threshold, 1);
  EXPECT_TRUE(facts.at("adapting").learned);
  EXPECT_NEAR(facts.at("adapting").error_to_threshold, 3, 1e-3);
  EXPECT_FALSE(facts.at("adapting").began_on_ball);
}

TEST_P(EveryPrecision, ProjectionActsOnTheBall) {
  const TickFacts facts = all_facts().at("projection_ball");
  EXPECT_TRUE(facts.began_on_ball);
  EXPECT_TRUE(facts.gradient_outwards);
  EXPECT_TRUE(facts.learned);
  EXPECT_NEAR(facts.weight_norm, facts.weight_radius, 1e-4 * facts.weight_radius);
}

TEST_P(EveryPrecision, TheEdgeIsJustOutsideOfTheDeadZone) {
  const TickFacts facts = all_facts().at("dead_zone_edge");
  EXPECT_GT(facts.error_to_threshold, 1);
  EXPECT_LT(facts.error_to_threshold, 1 + 1e-5);
  EXPECT_TRUE(facts.learned);
}

TEST_P(EveryPrecision, EverySigmoidIsSaturated) {
  EXPECT_GT(all_facts().at("saturated_sigmoids").smallest_sigmoid, 1 - 1e-6);
  EXPECT_LT(all_facts().at("healthy").smallest_sigmoid, 0.9);
}

TEST_P(EveryPrecision, OutputWeightsAreSubnormal) {
  EXPECT_EQ(all_facts().at("subnormals").share_subnormal, 1);
  EXPECT_EQ(all_facts().at("adapting").share_subnormal, 0);
}

TEST_P(EveryPrecision, LargestValuesLieAtTheRobotsLimits) {
  const TickFacts facts = all_facts().at("largest_values");
  for (std::size_t j = 0; j < robot_.joints.size(); ++j) {
    const Joint<double>& joint = robot_.joints[j].joint;
    EXPECT_GT(std::fabs(facts.q[j]), 0.99 * joint.max_position);
    EXPECT_GT(std::fabs(facts.dq[j]), 0.99 * joint.max_velocity);
    EXPECT_GT(std::fabs(facts.tau[j]), 0.99 * joint.max_torque);
  }
}

TEST_P(EveryPrecision, AFloodFillsTheTick) {
  const auto facts = all_facts();
  EXPECT_EQ(facts.at("flooded_bus").frames, static_cast<std::size_t>(kMostFramesPerTick));
  EXPECT_EQ(facts.at("adapting").frames, 2 * robot_.joints.size());
  EXPECT_TRUE(facts.at("flooded_bus").learned);
}

TEST_P(EveryPrecision, MutationsStayInsideWhatASampleMayBe) {
  auto generator = test::seeded_generator();
  const SampleRange range = sample_range(robot_);
  TickInput input = scenarios(robot_, GetParam()).front().input;
  int watched = 0;
  for (int i = 0; i < 500; ++i) {
    input = mutated(input, robot_, range, GetParam(), generator);
    EXPECT_EQ(input.foreign_frames, 0);
    for (std::size_t j = 0; j < range.dq_max.size(); ++j) {
      EXPECT_GE(input.q[j], range.q_min[j]);
      EXPECT_LE(input.q[j], range.q_max[j]);
      EXPECT_LE(std::fabs(input.dq[j]), range.dq_max[j]);
      EXPECT_LE(std::fabs(input.tau[j]), range.tau_max[j]);
    }
    tick_->prepare(input);
    if (tick_->facts().watched) ++watched;
  }
  // Few are refused; those are no ticks of a running monitor.
  EXPECT_GT(watched, 450);
}

}  // namespace
}  // namespace offnominal::desk::wcet
