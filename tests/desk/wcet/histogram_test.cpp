#include "wcet/histogram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "support/seed.hpp"

namespace offnominal::desk::wcet {
namespace {

TEST(Histogram, IsEmptyAtFirst) {
  const Histogram h;
  EXPECT_EQ(h.count(), 0U);
  EXPECT_EQ(h.min_ns(), 0);
  EXPECT_EQ(h.max_ns(), 0);
  EXPECT_EQ(h.quantile_ns(0.5), 0);
  EXPECT_TRUE(h.bins().empty());
  EXPECT_TRUE(h.log_bins(10).empty());
}

TEST(Histogram, PutsDurationsIntoBinsOfTenNanosecondsThenOfOneMicrosecond) {
  Histogram h;
  for (const std::int64_t ns : {0, 9, 10, 99'999, 100'000, 100'999, 101'000, 99'999'999})
    h.record(ns);
  const auto bins = h.bins();
  ASSERT_EQ(bins.size(), 6U);
  const std::int64_t expected[][3]{{0, 10, 2},
                                   {10, 20, 1},
                                   {99'990, 100'000, 1},
                                   {100'000, 101'000, 2},
                                   {101'000, 102'000, 1},
                                   {99'999'000, 100'000'000, 1}};
  for (std::size_t i = 0; i < bins.size(); ++i) {
    EXPECT_EQ(bins[i].begin_ns, expected[i][0]) << i;
    EXPECT_EQ(bins[i].end_ns, expected[i][1]) << i;
    EXPECT_EQ(bins[i].count, static_cast<std::uint64_t>(expected[i][2])) << i;
  }
}

TEST(Histogram, KeepsWhatIsLongerThanAllBins) {
  Histogram h;
  h.record(50);
  h.record(100'000'000);
  h.record(7'000'000'000);
  EXPECT_EQ(h.max_ns(), 7'000'000'000);
  ASSERT_EQ(h.bins().size(), 2U);
  EXPECT_EQ(h.bins()[1].count, 2U);
  EXPECT_EQ(h.bins()[1].begin_ns, 100'000'000);
  EXPECT_GT(h.bins()[1].end_ns, h.max_ns());
  EXPECT_EQ(h.quantile_ns(1), 7'000'000'000);
}

TEST(Histogram, CountsANegativeDurationAsZero) {
  Histogram h;
  h.record(-5);
  EXPECT_EQ(h.min_ns(), 0);
  EXPECT_EQ(h.bins().front().count, 1U);
}

// Durations over nine powers of ten against the sorted list of themselves.
TEST(Histogram, AgreesWithASortedList) {
  auto generator = test::seeded_generator();
  std::uniform_real_distribution<double> exponent(0, 8.5);
  Histogram h;
  std::vector<std::int64_t> all;
  double sum = 0;
  for (int i = 0; i < 20'000; ++i) {
    all.push_back(std::llround(std::pow(10.0, exponent(generator))));
    sum += static_cast<double>(all.back());
    h.record(all.back());
  }
  std::sort(all.begin(), all.end());
  EXPECT_EQ(h.count(), all.size());
  EXPECT_EQ(h.min_ns(), all.front());
  EXPECT_EQ(h.max_ns(), all.back());
  EXPECT_NEAR(h.mean_ns(), sum / static_cast<double>(all.size()), 1e-9 * sum);
  for (const double p : {0.0, 0.001, 0.25, 0.5, 0.9, 0.99, 0.999, 0.9999, 1.0}) {
    const auto rank =
        static_cast<std::size_t>(std::max(std::ceil(p * static_cast<double>(all.size())) - 1, 0.0));
    const std::int64_t exact = all[rank];
    const std::int64_t width = exact < 100'000 ? 10 : 1'000;
    EXPECT_GE(h.quantile_ns(p), exact) << p;
    if (exact < 100'000'000) {
      EXPECT_LE(h.quantile_ns(p), exact + width) << p;
    }
    EXPECT_LE(h.quantile_ns(p), h.max_ns()) << p;
  }
}

TEST(Histogram, LosesNothingInLogarithmicBins) {
  auto generator = test::seeded_generator();
  std::uniform_real_distribution<double> exponent(0, 8.5);
  Histogram h;
  for (int i = 0; i < 5'000; ++i) h.record(std::llround(std::pow(10.0, exponent(generator))));
  for (const int per_decade : {1, 5, 20, 60}) {
    std::uint64_t sum = 0;
    std::int64_t end = -1;
    for (const Histogram::Bin& bin : h.log_bins(per_decade)) {
      if (end >= 0) {
        EXPECT_EQ(bin.begin_ns, end);
      }
      EXPECT_LT(bin.begin_ns, bin.end_ns);
      end = bin.end_ns;
      sum += bin.count;
    }
    EXPECT_EQ(sum, h.count()) << per_decade;
    EXPECT_GT(end, h.max_ns());
  }
}

}  // namespace
}  // namespace offnominal::desk::wcet
