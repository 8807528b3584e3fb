#include "wcet/search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "paper/two_link_robot.hpp"

namespace offnominal::desk::wcet {
namespace {

// Costs with one summit: everything at a tenth of the largest sample, with a threshold of 1.
double summit(const TickInput& input) {
  double away = std::fabs(std::log(input.threshold));
  for (const double tau : input.tau) away += std::fabs(tau - 100) / 100;
  return 1000 / (1 + away);
}

class Search : public testing::Test {
 protected:
  std::vector<Candidate> run(int evaluations, std::uint64_t seed, const CostOf& cost = summit) {
    std::vector<TickInput> beginnings;
    for (const Scenario& scenario : scenarios(robot_, Precision::kFloat)) {
      beginnings.push_back(scenario.input);
    }
    return search_worst(beginnings, cost,
                        [this](const TickInput& input, std::mt19937_64& generator) {
                          return mutated(input, robot_, range_, Precision::kFloat, generator);
                        },
                        {.evaluations = evaluations, .seed = seed});
  }

  RobotDescription robot_ = paper::two_link_robot();
  SampleRange range_ = sample_range(robot_);
};

TEST_F(Search, ClimbsFarAboveItsBeginnings) {
  const double at_first = run(0, 1).front().cost_ns;
  const double after = run(3000, 1).front().cost_ns;
  EXPECT_LT(at_first, 500);
  EXPECT_GT(after, 800);
}

TEST_F(Search, GivesItsCandidatesCostliestFirst) {
  const auto candidates = run(500, 3);
  ASSERT_EQ(candidates.size(), 8U);
  for (std::size_t i = 1; i < candidates.size(); ++i) {
    EXPECT_GE(candidates[i - 1].cost_ns, candidates[i].cost_ns);
  }
}

TEST_F(Search, RepeatsWithItsSeed) {
  const auto a = run(500, 7);
  const auto b = run(500, 7);
  const auto c = run(500, 8);
  EXPECT_EQ(a.front().cost_ns, b.front().cost_ns);
  EXPECT_EQ(a.front().input.tau, b.front().input.tau);
  EXPECT_NE(a.front().input.tau, c.front().input.tau);
}

TEST_F(Search, DropsWhatCannotBe) {
  EXPECT_TRUE(run(50, 1, [](const TickInput&) { return -1.0; }).empty());
  const auto only_learning =
      run(500, 1, [](const TickInput& input) { return input.error_to_threshold > 1 ? 1.0 : -1.0; });
  for (const Candidate& candidate : only_learning) {
    EXPECT_GT(candidate.input.error_to_threshold, 1);
  }
}

}  // namespace
}  // namespace offnominal::desk::wcet
