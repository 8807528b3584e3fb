#include "signal/shift.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using Eigen::Index;
using Eigen::VectorXd;
using offnominal::desk::ahead_by;

VectorXd cubic(Index count) {
  const Eigen::ArrayXd k = Eigen::ArrayXd::LinSpaced(count, 0, static_cast<double>(count - 1));
  return 0.01 * k.cube() - 0.3 * k.square() + k + 2;
}

TEST(AheadBy, IsExactForACubicInside) {
  const VectorXd signal = cubic(40);
  for (const double by : {0.25, 3.5, -0.75, -4.1, 2.0}) {
    const VectorXd shifted = ahead_by(signal, by);
    for (Index k = 8; k < 32; ++k) {
      const double at = static_cast<double>(k) + by;
      EXPECT_NEAR(shifted[k], 0.01 * std::pow(at, 3) - 0.3 * at * at + at + 2, 1e-10) << by;
    }
  }
}

TEST(AheadBy, WholeSamplesMoveAndTheEndsStay) {
  const VectorXd signal = VectorXd::LinSpaced(5, 0, 4);
  EXPECT_EQ(ahead_by(signal, 2), (VectorXd(5) << 2, 3, 4, 4, 4).finished());
  EXPECT_EQ(ahead_by(signal, -2), (VectorXd(5) << 0, 0, 0, 1, 2).finished());
  EXPECT_EQ(ahead_by(signal, 100), VectorXd::Constant(5, 4));
  EXPECT_EQ(ahead_by(signal, 0), signal);
  EXPECT_EQ(ahead_by(VectorXd(), 3).size(), 0);
}

TEST(AheadBy, IsOffByWhatItSaysForASine) {
  const Eigen::ArrayXd k = Eigen::ArrayXd::LinSpaced(400, 0, 399);
  const double w = 0.3;
  const VectorXd error = ahead_by((w * k).sin(), 0.5) - (w * (k + 0.5)).sin().matrix();
  EXPECT_LT(error.segment(5, 390).cwiseAbs().maxCoeff(), std::pow(w, 4) / 42);
  EXPECT_GT(error.segment(5, 390).cwiseAbs().maxCoeff(), std::pow(w, 4) / 50);
}

}  // namespace
