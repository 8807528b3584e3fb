#include "calibrate/false_alarms.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "support/seed.hpp"

namespace {

using namespace offnominal::desk;

double draw(const ExtremeLaw& law, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> uniform(0, 1);
  return exceeded_with(law, std::clamp(uniform(generator), 1e-12, 1 - 1e-12));
}

TEST(ExtremeLaw, IsFoundAgainFromItsOwnDraws) {
  auto generator = offnominal::test::seeded_generator();
  for (const ExtremeLaw& truth : {ExtremeLaw{0.8, 0.05, 0}, ExtremeLaw{2, 0.3, -0.2}}) {
    std::vector<double> maxima;
    for (int i = 0; i < 20000; ++i) maxima.push_back(draw(truth, generator));
    const ExtremeLaw found = extreme_law_of(maxima);
    for (const double p : {0.1, 1e-2, 1e-3, 1e-5}) {
      const double wanted = exceeded_with(truth, p);
      EXPECT_NEAR(exceeded_with(found, p), wanted, 0.1 * wanted) << p;
    }
  }
}

// A minute of the motion errs as a robot does that stands mostly and reverses now and then: what
// the many quiet blocks are like makes no tail.
TEST(ExtremeLaw, ManyQuietBlocksMakeTheTailOfTheOthersNoHeavier) {
  auto generator = offnominal::test::seeded_generator();
  const ExtremeLaw loud{0.8, 0.05, 0};
  std::vector<double> maxima;
  for (int i = 0; i < 60; ++i) maxima.push_back(draw(loud, generator));
  const double of_these = exceeded_with(extreme_law_of(maxima), 1e-5 * 300 / 60);
  for (int i = 60; i < 300; ++i) maxima.push_back(0.05 + 1e-4 * i);
  const double of_all = exceeded_with(extreme_law_of(maxima), 1e-5);
  EXPECT_LT(of_all, 2.5);
  EXPECT_NEAR(of_all, of_these, 0.4 * of_these);
}

TEST(ExtremeLaw, ATailWithAnEndIsTakenForGumbels) {
  std::vector<double> maxima;
  for (int i = 0; i < 1000; ++i) maxima.push_back(0.001 * i);
  const ExtremeLaw law = extreme_law_of(maxima);
  EXPECT_EQ(law.shape, 0);
  EXPECT_GT(exceeded_with(law, 1e-4), 1) << "beyond the end that the draws have";
}

TEST(ExtremeLaw, RarerIsLargerAndTheProbabilityComesBack) {
  for (const ExtremeLaw& law : {ExtremeLaw{1, 0.1, 0}, ExtremeLaw{1, 0.1, -0.1}}) {
    double last = -1e9;
    for (const double p : {0.9, 0.5, 0.1, 1e-3, 1e-6}) {
      const double value = exceeded_with(law, p);
      EXPECT_GT(value, last);
      last = value;
      const double y = (value - law.location) / law.scale;
      const double inner =
          law.shape == 0 ? std::exp(-y) : std::pow(1 - law.shape * y, 1 / law.shape);
      EXPECT_NEAR(-std::expm1(-inner), p, 1e-9);
    }
  }
}

TEST(ExtremeLaw, EqualMaximaHaveNoSpread) {
  EXPECT_NEAR(exceeded_with(extreme_law_of(std::vector<double>(20, 0.7)), 1e-6), 0.7, 1e-9);
}

TEST(ExtremeLaw, RefusesTooFewBlocks) {
  EXPECT_THROW(static_cast<void>(extreme_law_of(std::vector<double>(9, 1.0))),
               std::invalid_argument);
}

TEST(BlockMaxima, TheRestJoinsTheLastBlock) {
  const Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(11, 0, 10);
  EXPECT_EQ(block_maxima(values, 4), (std::vector<double>{3, 10}));
  EXPECT_TRUE(block_maxima(values, 12).empty());
}

TEST(Counts, NoneInThreeHundredSecondsExcludesMoreThanOneInAHundred) {
  EXPECT_NEAR(highest_rate(0, 300), 0.00999, 1e-4);
  EXPECT_NEAR(highest_rate(3, 1), 7.7537, 1e-3);  // table of the chi-squared law
}

TEST(Counts, AsManyAsThatByChance) {
  EXPECT_EQ(probability_of_as_many(0, 0.1), 1);
  EXPECT_NEAR(probability_of_as_many(1, 0.1), 1 - std::exp(-0.1), 1e-12);
  EXPECT_NEAR(probability_of_as_many(2, 0.1), 1 - 1.1 * std::exp(-0.1), 1e-12);
}

}  // namespace
