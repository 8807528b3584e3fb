#include "analysis/shape_search.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "analysis/fit.hpp"
#include "recorded_arm.hpp"

namespace {

using Eigen::Index;
using Eigen::VectorXd;
using namespace offnominal::tools;

TEST(PeriodogramPeaks, StandAtTheHiddenPeriods) {
  std::mt19937_64 generator(5);
  std::normal_distribution<double> normal;
  VectorXd phase(3000);
  VectorXd values(3000);
  for (Index i = 0; i < 3000; ++i) {
    phase[i] = 6 * std::sin(0.01 * static_cast<double>(i));
    values[i] = std::sin(12 * phase[i]) + 0.5 * std::cos(30.2 * phase[i]) + 0.3 * normal(generator);
  }
  std::vector<double> grid;
  for (int k = 0; k < 400; ++k) grid.push_back(1 + 0.1 * k);
  const std::vector<double> peaks = periodogram_peaks(phase, values, grid, 2);
  ASSERT_EQ(peaks.size(), 2U);
  EXPECT_NEAR(peaks[0], 12, 0.1);
  EXPECT_NEAR(peaks[1], 30.2, 0.1);
}

TEST(ContiguousParts, CoverTheRecordingInTurnWithGaps) {
  const std::vector<int> parts = contiguous_parts(2003, 4);
  ASSERT_EQ(parts.size(), 2003U);
  EXPECT_EQ(parts[0], 0);
  EXPECT_EQ(parts[95], 0);
  for (std::size_t i = 96; i < 104; ++i) EXPECT_EQ(parts[i], -1) << i;
  EXPECT_EQ(parts[104], 1);
  EXPECT_EQ(parts[550], 0);
  EXPECT_EQ(parts[2002], 4);
}

TEST(CorrelationSamples, GrowWithTheCorrelation) {
  std::mt19937_64 generator(5);
  std::normal_distribution<double> normal;
  const auto autoregressive = [&](double a) {
    VectorXd x(20000);
    x[0] = 0;
    for (Index i = 1; i < x.size(); ++i) x[i] = a * x[i - 1] + normal(generator);
    return x;
  };
  EXPECT_NEAR(correlation_samples(autoregressive(0)), 1, 0.2);
  EXPECT_NEAR(correlation_samples(autoregressive(0.9)), (1 + 0.9) / (1 - 0.9), 4);
  EXPECT_EQ(correlation_samples(VectorXd::Ones(100)), 1);
}

}  // namespace
