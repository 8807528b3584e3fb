#include "look/relation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using Eigen::Index;
using Eigen::VectorXd;
using offnominal::desk::longest_stretch;
using offnominal::desk::Relation;
using offnominal::desk::relation_of;
using ::testing::HasSubstr;

struct Motion {
  VectorXd t, q, dq;
};
Motion motion(Index samples, double period_s) {
  Motion of{VectorXd(samples), VectorXd(samples), VectorXd(samples)};
  for (Index i = 0; i < samples; ++i) {
    of.t[i] = period_s * static_cast<double>(i);
    of.q[i] = std::sin(3 * of.t[i]);
    of.dq[i] = 3 * std::cos(3 * of.t[i]);
  }
  return of;
}

TEST(Relation, IsTheFactorToTheDerivative) {
  const Motion of = motion(2000, 0.002);
  EXPECT_NEAR(*relation_of(of.q, of.dq, of.t).ratio, 1, 0.01);
  EXPECT_NEAR(*relation_of(of.q, VectorXd(-57.3 * of.dq), of.t).ratio, -57.3, 0.6);
}

TEST(Relation, ThatIsNoneIsJudgedToBeNone) {
  const Motion of = motion(2000, 0.002);
  const VectorXd other = (7 * of.t.array()).sin().matrix();
  const Relation relation = relation_of(of.q, other, of.t);
  EXPECT_FALSE(relation.ratio);
  EXPECT_EQ(relation.not_judged, "");
}

TEST(Relation, GapsNansAndJitterLeaveAStretchToJudge) {
  Motion of = motion(3000, 0.002);
  of.q[700] = std::nan("");
  of.dq[701] = std::numeric_limits<double>::infinity();
  // 0.5 s are missing, and the stamps of the rest are off by up to a third of a step.
  of.t.tail(1000).array() += 0.5;
  for (Index i = 0; i < 3000; ++i) of.t[i] += 0.0006 * std::sin(static_cast<double>(i * i));
  for (Index i = 0; i < 3000; ++i) {
    if (i == 700 || i == 701) continue;
    of.q[i] = std::sin(3 * of.t[i]);
    of.dq[i] = 3 * std::cos(3 * of.t[i]);
  }
  const Relation relation = relation_of(of.q, of.dq, of.t);
  ASSERT_TRUE(relation.ratio) << relation.not_judged << relation.correlation;
  EXPECT_NEAR(*relation.ratio, 1, 0.05);
}

TEST(Relation, SaysWhyItWasNotJudged) {
  Motion of = motion(1000, 0.002);
  for (Index i = 0; i < 1000; i += 100) of.q[i] = std::nan("");
  EXPECT_THAT(relation_of(of.q, of.dq, of.t).not_judged, HasSubstr("NaN"));
  of = motion(1000, 0.002);
  for (Index gap = 100; gap < 1000; gap += 100) of.t.tail(1000 - gap).array() += 0.1;
  EXPECT_THAT(relation_of(of.q, of.dq, of.t).not_judged, HasSubstr("gaps"));
  of = motion(100, 0.002);
  EXPECT_THAT(relation_of(of.q, of.dq, of.t).not_judged, HasSubstr("100 samples"));
  of = motion(1000, 0.002);
  EXPECT_THAT(relation_of(VectorXd::Zero(1000), of.dq, of.t).not_judged, HasSubstr("never"));
  EXPECT_THAT(relation_of(VectorXd::Zero(900), of.dq, of.t).not_judged, HasSubstr("numbers"));
}

TEST(Relation, TheLongestStretchIsTheOneWithoutGapAndNan) {
  Motion of = motion(1000, 0.01);
  Eigen::MatrixXd columns = of.q;
  columns(100, 0) = std::nan("");
  of.t.tail(300).array() += 1;
  const auto stretch = longest_stretch(of.t, columns);
  EXPECT_EQ(stretch.first, 101);
  EXPECT_EQ(stretch.count, 599);
  EXPECT_TRUE(stretch.has_gap);
  EXPECT_TRUE(stretch.has_not_finite);
}

}  // namespace
