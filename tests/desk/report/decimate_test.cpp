#include "report/decimate.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "sample.hpp"
#include "support/seed.hpp"

namespace offnominal::desk::report {
namespace {

using test::kGap;
using ::testing::Contains;

Series noise(std::size_t size, std::mt19937_64& generator) {
  std::normal_distribution<double> normal;
  Series series{.name = "noise"};
  for (std::size_t i = 0; i < size; ++i) {
    series.x.push_back(0.001 * static_cast<double>(i));
    series.y.push_back(normal(generator));
  }
  return series;
}

TEST(Decimate, LeavesASeriesThatFitsAsItIs) {
  auto generator = offnominal::test::seeded_generator();
  const Series series = noise(100, generator);
  const Series reduced = decimate(series, 100);
  EXPECT_EQ(reduced.x, series.x);
  EXPECT_EQ(reduced.y, series.y);
}

TEST(Decimate, NeverExceedsTheBudgetAndKeepsOnlyRecordedPointsInOrder) {
  auto generator = offnominal::test::seeded_generator();
  for (const std::size_t size : {17U, 33U, 1000U, 25001U}) {
    for (const std::size_t budget : {16U, 17U, 100U, 4000U}) {
      for (const SeriesKind kind : {SeriesKind::kLine, SeriesKind::kSteps, SeriesKind::kPoints}) {
        Series series = noise(size, generator);
        series.kind = kind;
        const Series reduced = decimate(series, budget);
        ASSERT_LE(reduced.x.size(), std::max<std::size_t>(budget, 16));
        ASSERT_EQ(reduced.x.size(), reduced.y.size());
        EXPECT_EQ(reduced.x.front(), series.x.front());
        EXPECT_EQ(reduced.x.back(), series.x.back());
        EXPECT_TRUE(std::is_sorted(reduced.x.begin(), reduced.x.end()));
        std::map<double, double> recorded;
        for (std::size_t i = 0; i < size; ++i) recorded[series.x[i]] = series.y[i];
        for (std::size_t i = 0; i < reduced.x.size(); ++i) {
          ASSERT_EQ(recorded.at(reduced.x[i]), reduced.y[i]);
        }
      }
    }
  }
}

TEST(Decimate, KeepsASpikeOfOneSampleWhereverItIs) {
  auto generator = offnominal::test::seeded_generator();
  std::uniform_int_distribution<std::size_t> place(0, 24999);
  for (int run = 0; run < 200; ++run) {
    Series series = noise(25000, generator);
    series.y[place(generator)] = 100.0;
    const Series reduced = decimate(series, 400);
    ASSERT_THAT(reduced.y, Contains(100.0));
    ASSERT_THAT(reduced.y, Contains(*std::min_element(series.y.begin(), series.y.end())));
  }
}

TEST(Decimate, KeepsAGapOfOneSample) {
  auto generator = offnominal::test::seeded_generator();
  for (const std::size_t place : {1U, 777U, 9998U}) {
    Series series = noise(10000, generator);
    series.y[place] = kGap;
    const Series reduced = decimate(series, 100);
    EXPECT_EQ(
        std::count_if(reduced.y.begin(), reduced.y.end(), [](double y) { return std::isnan(y); }),
        1);
    EXPECT_LE(reduced.x.size(), 100U);
  }
}

TEST(Decimate, KeepsBothEdgesOfABand) {
  auto generator = offnominal::test::seeded_generator();
  Series series = noise(10000, generator);
  series.kind = SeriesKind::kBand;
  series.y_upper = series.y;
  for (double& upper : series.y_upper) upper += 1.0;
  series.y[1234] = -50.0;
  series.y_upper[4321] = 60.0;
  const Series reduced = decimate(series, 100);
  EXPECT_THAT(reduced.y, Contains(-50.0));
  EXPECT_THAT(reduced.y_upper, Contains(60.0));
  EXPECT_EQ(reduced.y.size(), reduced.y_upper.size());
}

TEST(Decimate, KeepsACloudsOutermostPointsAndItsInside) {
  auto generator = offnominal::test::seeded_generator();
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Series cloud{.name = "cloud", .kind = SeriesKind::kPoints};
  for (int i = 0; i < 20000; ++i) {
    cloud.x.push_back(uniform(generator));
    cloud.y.push_back(uniform(generator));
  }
  cloud.x[5037] = -9.0;
  cloud.x[6041] = 9.0;
  const Series reduced = decimate(cloud, 400);
  EXPECT_THAT(reduced.x, Contains(-9.0));
  EXPECT_THAT(reduced.x, Contains(9.0));
  EXPECT_GT(
      std::count_if(reduced.y.begin(), reduced.y.end(), [](double y) { return std::abs(y) < 0.5; }),
      50);
}

TEST(Decimate, NeverReducesBars) {
  Series bars{.name = "bars", .kind = SeriesKind::kBars};
  for (int i = 0; i <= 5000; ++i) bars.x.push_back(i);
  bars.y.assign(5000, 1.0);
  EXPECT_EQ(decimate(bars, 100).y.size(), 5000U);
}

}  // namespace
}  // namespace offnominal::desk::report
