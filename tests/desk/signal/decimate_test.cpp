#include "signal/decimate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace {

using Eigen::VectorXd;
using offnominal::desk::decimate;
using offnominal::desk::every_nth;

VectorXd sine(double frequency_hz) {
  const VectorXd t = VectorXd::LinSpaced(4001, 0, 4);
  return (2 * std::numbers::pi * frequency_hz * t).array().sin();
}

TEST(Decimate, TakesEveryNthFromTheFirst) {
  VectorXd signal(7);
  signal << 0, 1, 2, 3, 4, 5, 6;
  VectorXd expected(3);
  expected << 0, 3, 6;
  EXPECT_EQ(every_nth(signal, 3), expected);
  EXPECT_EQ(every_nth(signal, 1), signal);
  EXPECT_EQ(every_nth(signal, 100).size(), 1);
}

TEST(Decimate, TakesEveryNthRowAsItDoesSamples) {
  Eigen::MatrixXd signals(7, 2);
  signals << 0, 10, 1, 11, 2, 12, 3, 13, 4, 14, 5, 15, 6, 16;
  const Eigen::MatrixXd kept = offnominal::desk::every_nth_row(signals, 3);
  ASSERT_EQ(kept.rows(), 3);
  EXPECT_EQ(kept.col(0), every_nth(signals.col(0), 3));
  EXPECT_EQ(kept.col(1), every_nth(signals.col(1), 3));
}

TEST(Decimate, KeepsWhatIsSlow) {
  const VectorXd slow = sine(2);
  const VectorXd out = decimate(slow, 10);
  ASSERT_EQ(out.size(), 401);
  EXPECT_LT((out - every_nth(slow, 10)).segment(20, 360).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(Decimate, RemovesWhatWouldAlias) {
  const VectorXd alias = sine(103);  // 3 Hz at 100 samples a second
  EXPECT_GT(every_nth(alias, 10).cwiseAbs().maxCoeff(), 0.9);
  EXPECT_LT(decimate(alias, 10).segment(20, 360).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(Decimate, RefusesAFactorBelowOne) {
  EXPECT_THROW(decimate(VectorXd::Zero(10), 0), std::invalid_argument);
  EXPECT_THROW(every_nth(VectorXd::Zero(10), -1), std::invalid_argument);
}

}  // namespace
