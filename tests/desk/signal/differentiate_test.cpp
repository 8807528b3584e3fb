#include "signal/differentiate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace {

using Eigen::VectorXd;
using offnominal::desk::central_difference;

TEST(CentralDifference, ParabolaIsExactUpToItsEnds) {
  const VectorXd t = VectorXd::LinSpaced(11, 0, 1);
  const VectorXd slope = central_difference(3 * t.array().square() - t.array(), 0.1);
  EXPECT_LT((slope.array() - (6 * t.array() - 1)).abs().maxCoeff(), 1e-12);
}

TEST(CentralDifference, SineIsOffByTheKnownFactor) {
  const double w = 30;
  const double h = 0.01;
  const VectorXd t = VectorXd::LinSpaced(101, 0, 1);
  const VectorXd slope = central_difference((w * t).array().sin(), h);
  const VectorXd exact = w * (w * t).array().cos() * std::sin(w * h) / (w * h);
  EXPECT_LT((slope - exact).segment(1, 99).cwiseAbs().maxCoeff(), 1e-11);
}

TEST(CentralDifference, RefusesTooFewSamplesAndNoPeriod) {
  EXPECT_THROW(central_difference(VectorXd::Zero(2), 0.1), std::invalid_argument);
  EXPECT_THROW(central_difference(VectorXd::Zero(5), 0), std::invalid_argument);
}

}  // namespace
