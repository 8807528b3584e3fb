#include "wcet/extreme_value.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "support/seed.hpp"

namespace offnominal::desk::wcet {
namespace {

std::vector<double> gumbel_values(double location, double scale, int count,
                                  std::mt19937_64& generator) {
  std::extreme_value_distribution<double> gumbel(location, scale);
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(gumbel(generator));
  return values;
}

TEST(BlockMaxima, KeepsTheLargestOfEachWholeBlock) {
  BlockMaxima maxima(3, 10);
  for (const double x : {1, 5, 2, 7, 7, 1, -4, -2, -3, 100, 200}) maxima.record(x);
  EXPECT_EQ(std::vector<double>(maxima.maxima().begin(), maxima.maxima().end()),
            (std::vector<double>{5, 7, -2}));
}

TEST(BlockMaxima, TakesNoMoreThanItHasRoomFor) {
  BlockMaxima maxima(1, 2);
  for (int i = 0; i < 1000; ++i) maxima.record(i);
  EXPECT_EQ(maxima.maxima().size(), 2U);
}

// Standard errors of the estimates: 1.053 scale / sqrt(n) and 0.780 scale / sqrt(n).
TEST(GumbelFit, FindsTheDistributionThatTheValuesAreFrom) {
  auto generator = test::seeded_generator();
  for (const auto& [location, scale] : {std::pair{3.0, 0.5}, {-200.0, 40.0}, {1e6, 3.0}}) {
    const auto values = gumbel_values(location, scale, 4000, generator);
    const auto fit = fit_gumbel(values);
    ASSERT_TRUE(fit);
    const double root = std::sqrt(4000.0);
    EXPECT_NEAR(fit->location, location, 5 * 1.053 * scale / root);
    EXPECT_NEAR(fit->scale, scale, 5 * 0.780 * scale / root);
    EXPECT_LT(kolmogorov_statistic(*fit, values), 1.2);
  }
}

// Every step away from the fit makes the values less likely.
TEST(GumbelFit, IsOfLargestLikelihood) {
  auto generator = test::seeded_generator();
  const auto values = gumbel_values(10, 2, 200, generator);
  const auto fit = fit_gumbel(values);
  ASSERT_TRUE(fit);
  const auto log_likelihood = [&](double location, double scale) {
    double sum = 0;
    for (const double x : values) {
      const double z = (x - location) / scale;
      sum += -std::log(scale) - z - std::exp(-z);
    }
    return sum;
  };
  const double best = log_likelihood(fit->location, fit->scale);
  for (const double step : {-0.05, 0.05}) {
    EXPECT_LT(log_likelihood(fit->location + step, fit->scale), best);
    EXPECT_LT(log_likelihood(fit->location, fit->scale + step), best);
  }
}

TEST(GumbelFit, IsRefutedByValuesOfAnotherKind) {
  auto generator = test::seeded_generator();
  std::vector<double> two_kinds = gumbel_values(10, 0.1, 500, generator);
  for (std::size_t i = 0; i < two_kinds.size(); i += 5) two_kinds[i] += 30;
  const auto fit = fit_gumbel(two_kinds);
  ASSERT_TRUE(fit);
  EXPECT_GT(kolmogorov_statistic(*fit, two_kinds), kKolmogorovLimit);
}

// The limit rejects 5 % of what is right: of 400 samples 20, give or take 4.4.
TEST(GumbelFit, IsRefutedByWhatIsRightOnceInTwentyTimes) {
  auto generator = test::seeded_generator();
  int rejected = 0;
  for (int i = 0; i < 400; ++i) {
    const auto values = gumbel_values(5, 1, 200, generator);
    if (kolmogorov_statistic(*fit_gumbel(values), values) > kKolmogorovLimit) ++rejected;
  }
  EXPECT_GE(rejected, 4);
  EXPECT_LE(rejected, 40);
}

TEST(GumbelFit, IsNoneWhereItCannotBeMade) {
  EXPECT_FALSE(fit_gumbel(std::vector<double>(kLeastMaxima - 1, 1.0)));
  EXPECT_FALSE(fit_gumbel(std::vector<double>(1000, 7.0)));
}

TEST(ExceededWith, TurnsAProbabilityPerBlockIntoOnePerValue) {
  const GumbelFit fit{100, 5};
  // P(block's largest <= x) = (1 - p)^n, solved for x by hand.
  for (const auto& [block, p] :
       {std::pair<std::int64_t, double>{1, 0.01}, {1000, 1e-4}, {1000, 1e-9}}) {
    const double expected = 100 - 5 * std::log(-static_cast<double>(block) * std::log1p(-p));
    EXPECT_NEAR(exceeded_with(fit, block, p), expected, 1e-9 * expected);
  }
}

// The whole chain on values whose tail is known: exponential, largest of blocks tends to Gumbel.
TEST(ExceededWith, FindsTheTailOfExponentialValues) {
  auto generator = test::seeded_generator();
  std::exponential_distribution<double> values(1.0);
  BlockMaxima maxima(500, 2000);
  for (int i = 0; i < 1'000'000; ++i) maxima.record(values(generator));
  const auto fit = fit_gumbel(maxima.maxima());
  ASSERT_TRUE(fit);
  const double exact = -std::log(1e-9);  // 20.7
  EXPECT_NEAR(exceeded_with(*fit, 500, 1e-9), exact, 0.06 * exact);
}

}  // namespace
}  // namespace offnominal::desk::wcet
