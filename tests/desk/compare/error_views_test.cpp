#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "compare/error_map.hpp"
#include "compare/error_spectrum.hpp"
#include "compare/error_variable.hpp"
#include "compare/torque_charts.hpp"

namespace {

using Eigen::VectorXd;
using namespace offnominal::desk;

constexpr double kTwoPi = 6.283185307179586;

VectorXd times(int count, double period_s) {
  return VectorXd::LinSpaced(count, 0, (count - 1) * period_s);
}

// The place and the height of the highest peak.
std::pair<double, double> peak_of(const Spectrum& spectrum) {
  const auto highest = std::max_element(spectrum.amplitude.begin(), spectrum.amplitude.end());
  const auto at = static_cast<std::size_t>(highest - spectrum.amplitude.begin());
  return {spectrum.at[at], *highest};
}

TEST(SinceReversal, BeginsAtZeroWhenTheJointTurnsRound) {
  const VectorXd t = times(8, 0.5);
  VectorXd velocity(8);
  // Noise at rest, 1 % of the largest, is no direction.
  velocity << 1, 1, -0.01, 0.01, -0.01, -1, -1, 1;
  const VectorXd since = since_reversal(t, velocity);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(std::isnan(since[i])) << i;
  EXPECT_EQ(since[5], 0);
  EXPECT_EQ(since[6], 0.5);
  EXPECT_EQ(since[7], 0);
}

TEST(SinceReversal, IsUnknownOfWhatNeverTurnsAndOfNothing) {
  EXPECT_TRUE(since_reversal(times(5, 1), VectorXd::Ones(5)).array().isNaN().all());
  EXPECT_TRUE(since_reversal(times(5, 1), VectorXd::Zero(5)).array().isNaN().all());
  EXPECT_EQ(since_reversal(VectorXd(), VectorXd()).size(), 0);
}

TEST(ErrorVariables, AreFoundByTheirNames) {
  for (const ErrorVariable variable : kErrorVariables) {
    EXPECT_EQ(error_variable(name_of(variable)), variable);
  }
  EXPECT_FALSE(error_variable("colour"));
}

TEST(MeanMap, HoldsTheMeanOfEveryCellAndLeavesEmptyOnesEmpty) {
  VectorXd x(5);
  VectorXd y(5);
  VectorXd error(5);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  x << 0, 0.01, 1, 1, nan;
  y << 0, 0.01, 2, 2, 1;
  error << 1, 2, -3, nan, 100;
  const report::Heatmap map =
      mean_map("a map", {{"x", "1"}, x}, {{"y", "1"}, y}, {{"e", "1"}, error});
  ASSERT_EQ(map.x_edges.size(), 21U);
  EXPECT_EQ(map.x_edges.front(), 0);
  EXPECT_EQ(map.y_edges.back(), 2);
  EXPECT_EQ(map.value.front(), 1.5);
  EXPECT_EQ(map.value.back(), -3);
  EXPECT_EQ(
      std::count_if(map.value.begin(), map.value.end(), [](double v) { return !std::isnan(v); }),
      2);
}

TEST(MeanMap, IsOneEmptyCellWhereNothingIsKnown) {
  const VectorXd none = VectorXd::Constant(3, std::numeric_limits<double>::quiet_NaN());
  for (const VectorXd& values : {none, VectorXd()}) {
    const report::Heatmap map =
        mean_map("a map", {{"x", "1"}, values}, {{"y", "1"}, values}, {{"e", "1"}, values});
    ASSERT_EQ(map.value.size(), 1U);
    EXPECT_TRUE(std::isnan(map.value[0]));
  }
}

TEST(MeanMap, TakesAVariableThatStaysWhereItIs) {
  const VectorXd still = VectorXd::Constant(4, 0.7);
  const report::Heatmap map =
      mean_map("a map", {{"x", "1"}, still}, {{"y", "1"}, still}, {{"e", "1"}, still});
  EXPECT_TRUE(std::is_sorted(map.x_edges.begin(), map.x_edges.end(), std::less_equal<>()));
  EXPECT_DOUBLE_EQ(map.value.front(), 0.7);
}

TEST(SpectrumOverTime, ShowsASineAtItsFrequencyAndHeight) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 0.3);
  for (const int count : {600, 40000}) {
    const VectorXd t = times(count, 0.01);
    const VectorXd values =
        t.unaryExpr([&](double s) { return 4 + 0.8 * std::sin(kTwoPi * 3.1 * s) + noise(random); });
    const auto [at_hz, height] = peak_of(spectrum_over_time(t, values, 12));
    EXPECT_NEAR(at_hz, 3.1, 0.1) << count;
    EXPECT_NEAR(height, 0.8, 0.15) << count;
  }
}

TEST(SpectrumOverTravel, ShowsARippleAtItsOrderHoweverFastTheJointMoves) {
  const VectorXd t = times(8000, 0.005);
  // There and back over 1.5 turns, ever faster.
  const VectorXd turns =
      t.unaryExpr([](double s) { return 0.75 * std::sin(0.2 * s + 0.02 * s * s); });
  const VectorXd values =
      turns.unaryExpr([](double turn) { return 2 + 0.5 * std::cos(kTwoPi * 17 * turn); });
  const auto [order, height] = peak_of(spectrum_over_travel(t, turns, values, 12));
  EXPECT_NEAR(order, 17, 0.4);
  EXPECT_NEAR(height, 0.5, 0.1);
  // Over time it is smeared: no frequency has a third of it.
  EXPECT_LT(peak_of(spectrum_over_time(t, values, 12)).second, 0.5 / 3);
}

TEST(SpectrumOverTravel, EndsBeforeTheSamplesAreTooFarApart) {
  const VectorXd t = times(2000, 0.05);
  const VectorXd turns = t.unaryExpr([](double s) { return std::sin(0.3 * s); });
  const Spectrum spectrum = spectrum_over_travel(t, turns, VectorXd::Random(2000), 12);
  const double longest = (turns.tail(1999) - turns.head(1999)).cwiseAbs().maxCoeff();
  EXPECT_LE(spectrum.at.back(), 0.5 / longest);
  EXPECT_GT(spectrum.at.back(), 0.45 / longest);
}

TEST(Spectra, SayNothingOfWhatIsTooShortOrStandsStill) {
  EXPECT_TRUE(spectrum_over_time(times(5, 0.01), VectorXd::Ones(5), 12).at.empty());
  EXPECT_TRUE(spectrum_over_time(VectorXd(), VectorXd(), 12).at.empty());
  // Half a second has no two periods of what is slower than 1 Hz.
  EXPECT_TRUE(spectrum_over_time(times(50, 0.01), VectorXd::Ones(50), 1).at.empty());
  const VectorXd t = times(500, 0.01);
  EXPECT_TRUE(spectrum_over_travel(t, VectorXd::Ones(500), VectorXd::Ones(500), 12).at.empty());
  EXPECT_TRUE(spectrum_over_travel(VectorXd(), VectorXd(), VectorXd(), 12).at.empty());
}

TEST(BinnedMean, LeavesOutWhatIsUnknown) {
  VectorXd x(4);
  VectorXd y(4);
  x << 3, 1, std::numeric_limits<double>::quiet_NaN(), 2;
  y << 30, 10, 1000, 20;
  const report::Series line = binned_mean("mean", report::Tone::kModel, x, y);
  EXPECT_THAT(line.x, ::testing::ElementsAre(1, 2, 3));
  EXPECT_THAT(line.y, ::testing::ElementsAre(10, 20, 30));
}

}  // namespace
