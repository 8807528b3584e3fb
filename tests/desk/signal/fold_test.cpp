#include "signal/fold.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace offnominal::desk {
namespace {

using Eigen::VectorXd;
using testing::IsEmpty;

// Turns on at 3 rad/s, and is said between `low` and `low` + `range`.
VectorXd folded(double range, double low) {
  VectorXd q = VectorXd::LinSpaced(8000, 0, 80 - 0.01);
  for (double& angle : q) angle -= range * std::floor((angle - low) / range);
  return q;
}

TEST(KnownFold, IsATurnOrTheRangeOfTheMitProtocol) {
  constexpr double kTurn = 2 * std::numbers::pi;
  for (const double range : {kTurn, 25.0}) {
    VectorXd q = folded(range, -range / 2);
    const KnownFold fold = known_fold_of(q);
    EXPECT_EQ(fold.range, range);
    ASSERT_FALSE(fold.folds.empty());
    unfold(q, fold.range, fold.folds);
    EXPECT_LT((q - VectorXd::LinSpaced(8000, q[0], q[0] + 80 - 0.01)).cwiseAbs().maxCoeff(), 1e-9);
  }
}

// A sweep that only happens to be 25 wide, elsewhere or without its ends, is none.
TEST(KnownFold, IsNoneOfAnotherRangeOrPlace) {
  EXPECT_THAT(known_fold_of(folded(25, 0)).folds, IsEmpty());
  EXPECT_THAT(known_fold_of(folded(20, -10)).folds, IsEmpty());
  EXPECT_THAT(known_fold_of(VectorXd::LinSpaced(100, -12.5, 12.5)).folds, IsEmpty());
  EXPECT_THAT(known_fold_of(VectorXd()).folds, IsEmpty());
}

TEST(KnownFold, InAnyUnitIsATurnOfDegreesToo) {
  const VectorXd turns = folded(2 * std::numbers::pi, 0) * (180 / std::numbers::pi);
  const KnownFold degrees = known_fold_in_any_unit(turns);
  EXPECT_EQ(degrees.range, 360);
  EXPECT_FALSE(degrees.folds.empty());
  EXPECT_EQ(known_fold_in_any_unit(folded(25, -12.5)).range, 25);
  EXPECT_THAT(known_fold_in_any_unit(0.8 * turns).folds, IsEmpty());
  EXPECT_THAT(known_fold_in_any_unit(VectorXd()).folds, IsEmpty());
}

}  // namespace
}  // namespace offnominal::desk
