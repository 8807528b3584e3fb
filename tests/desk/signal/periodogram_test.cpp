#include "signal/periodogram.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace {

using Eigen::VectorXd;
using offnominal::desk::highest_peaks;
using offnominal::desk::periodogram;

const std::vector<double> kGrid{1, 1.5, 2, 2.5, 3, 3.5, 4, 4.5, 5};

TEST(Periodogram, IsTheSquaredSumOfTurnedValues) {
  const VectorXd phase = VectorXd::LinSpaced(57, -2, 7).array().square();
  const VectorXd values = (3 * phase).array().cos() + 0.2;
  const std::vector<double> power = periodogram(phase, values, kGrid);
  ASSERT_EQ(power.size(), kGrid.size());
  for (std::size_t k = 0; k < kGrid.size(); ++k) {
    const double cosine = ((kGrid[k] * phase).array().cos() * values.array()).sum();
    const double sine = ((kGrid[k] * phase).array().sin() * values.array()).sum();
    EXPECT_NEAR(power[k], cosine * cosine + sine * sine, 1e-8 * (1 + power[k])) << kGrid[k];
  }
}

TEST(Periodogram, OfNothingIsNothing) {
  EXPECT_TRUE(periodogram(VectorXd::Ones(3), VectorXd::Ones(3), {}).empty());
}

TEST(HighestPeaks, AreLocalMaximaInOrderOfTheGrid) {
  const std::vector<double> power{9, 1, 5, 1, 7, 1, 3, 2, 8};
  EXPECT_EQ(highest_peaks(kGrid, power, 3), (std::vector<double>{1, 3, 5}));
  EXPECT_EQ(highest_peaks(kGrid, power, 10), (std::vector<double>{1, 2, 3, 4, 5}));
}

TEST(HighestPeaks, APlateauIsOnePeak) {
  EXPECT_EQ(highest_peaks({1, 2, 3, 4}, {0, 5, 5, 0}, 4), (std::vector<double>{2}));
}

}  // namespace
