#include "live/history.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace offnominal::desk::live {
namespace {

using testing::ElementsAre;

void push(History& history, double t_s) {
  const std::array<double, 1> one{t_s};
  history.push(t_s, one, one, one, {one, one, one});
}

TEST(History, KeepsTheLastRowsInRoomThatIsTakenOnce) {
  History history(1, 1, 100);
  for (int i = 0; i < 1000; ++i) push(history, 0.001 * i);
  EXPECT_EQ(history.size(), 100U);
  EXPECT_DOUBLE_EQ(history.time_s(0), 0.9);
  EXPECT_DOUBLE_EQ(history.time_s(99), 0.999);
  const History::Rows rows = history.between(0.9495, 0.9525);
  EXPECT_EQ(rows.all.rows(), 3);
  EXPECT_DOUBLE_EQ(rows.time_s()[0], 0.95);
  history.clear();
  EXPECT_EQ(history.between(0, 1).all.rows(), 0);
}

TEST(History, HandsOverARecordingInTheOrderOfItsColumns) {
  History history(2, 1, 4);
  const std::array<double, 2> q{1, 2};
  const std::array<double, 2> dq{3, 4};
  const std::array<double, 2> tau{5, 6};
  const std::array<double, 1> residual{7};
  const std::array<double, 1> threshold{8};
  const std::array<double, 1> act{9};
  history.push(0.5, q, dq, tau, {residual, threshold, act});
  const History::Rows rows = history.between(0, 1);
  const Log log = rows.log("live", 0.001);
  EXPECT_EQ(log.t_s[0], 0.5);
  EXPECT_EQ(log.q.row(0), Eigen::RowVector2d(1, 2));
  EXPECT_EQ(log.dq.row(0), Eigen::RowVector2d(3, 4));
  EXPECT_EQ(log.tau.row(0), Eigen::RowVector2d(5, 6));
  EXPECT_EQ(rows.residual(0)[0], 7);
  EXPECT_EQ(rows.threshold(0)[0], 8);
  EXPECT_EQ(rows.act(0)[0], 9);
}

// A peak of one sample must not be lost between two steps, wherever it is.
TEST(Strip, KeepsTheLowestAndTheHighestOfEveryStep) {
  std::mt19937 random(7);  // printed by the values below
  std::vector<double> values;
  Strip strip(1);
  constexpr int kPerStep = 20;
  for (int i = 0; i < 50 * kPerStep; ++i) {
    values.push_back(std::normal_distribution<double>()(random));
    const std::array<double, 1> residual{values.back()};
    const std::array<double, 1> threshold{10 + values.back()};
    const std::array<double, 1> act{20 + values.back()};
    strip.push(0.001 * i + 1e-7, {residual, threshold, act});
  }
  const Strip::Steps steps = strip.since(0);
  ASSERT_EQ(steps.t_s.size(), 49U);  // the last is under way
  EXPECT_EQ(steps.next, 49U);
  for (std::size_t step = 0; step < steps.t_s.size(); ++step) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(step * kPerStep);
    const auto [low, high] = std::minmax_element(begin, begin + kPerStep);
    EXPECT_EQ(steps.low[0][step], *low) << step;
    EXPECT_EQ(steps.high[0][step], *high) << step;
    EXPECT_EQ(steps.threshold[0][step], 10 + *low) << step;
    EXPECT_EQ(steps.act[0][step], 20 + *low) << step;
  }
}

TEST(Strip, GivesWhatIsNewAndOnlyWhatIsKept) {
  Strip strip(1);
  const std::array<double, 1> one{1};
  EXPECT_TRUE(strip.since(0).t_s.empty());
  const std::size_t count = Strip::kSteps + 500;
  for (std::size_t i = 0; i < count; ++i)
    strip.push(Strip::kStepS * (0.5 + double(i)), {one, one, one});
  const Strip::Steps all = strip.since(0);
  EXPECT_EQ(all.first, 500U);
  EXPECT_EQ(all.next, count - 1);
  EXPECT_EQ(all.t_s.size(), Strip::kSteps - 1);
  EXPECT_EQ(strip.since(all.next).t_s.size(), 0U);
  EXPECT_EQ(strip.since(all.next - 3).t_s.size(), 3U);
  // From beyond what there is: a page of before the server was started anew.
  EXPECT_EQ(strip.since(all.next + 1000).next, all.next);
}

}  // namespace
}  // namespace offnominal::desk::live
