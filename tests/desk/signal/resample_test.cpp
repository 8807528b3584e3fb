#include "signal/resample.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace {

using Eigen::VectorXd;
using offnominal::desk::linear_at;
using offnominal::desk::spline_at;

VectorXd vector(std::initializer_list<double> values) {
  VectorXd result(static_cast<Eigen::Index>(values.size()));
  Eigen::Index i = 0;
  for (const double value : values) result[i++] = value;
  return result;
}

const VectorXd kAt = vector({0, .1, .25, .3, .5, .8});
const VectorXd kValue = vector({1, 2, 0, -1, .5, 3});

// scipy 1.10.1: scipy.interpolate.CubicSpline(at, value, bc_type='natural')(wanted)
TEST(Spline, EqualsScipy) {
  const VectorXd wanted = vector({0, .05, .2, .27, .4, .79, .8});
  const VectorXd expected = vector({1, 1.6665111940298507, 1.025566611387507, -0.4433582089552243,
                                    -0.9853855721393032, 2.950273562741846, 3});
  EXPECT_LT((spline_at(kAt, kValue, wanted) - expected).cwiseAbs().maxCoeff(), 1e-12);
}

// Whatever the order in which it is asked, and however far from the last question.
TEST(Spline, EqualsScipyInAnyOrderAndTimeAfterTime) {
  const offnominal::desk::Spline spline(kAt, kValue);
  const VectorXd wanted = vector({.8, 0, .4, .05, .79, .27, .2});
  const VectorXd expected = vector({3, 1, -0.9853855721393032, 1.6665111940298507,
                                    2.950273562741846, -0.4433582089552243, 1.025566611387507});
  EXPECT_LT((spline.at(wanted) - expected).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((spline.at(wanted.reverse()) - expected.reverse()).cwiseAbs().maxCoeff(), 1e-12);
}

// More points than the search walks over before it halves what is left.
TEST(Spline, FindsTheIntervalFarAhead) {
  const VectorXd at = VectorXd::LinSpaced(1000, 0, 999);
  const offnominal::desk::Spline line(at, 2 * at);
  const VectorXd wanted = vector({0.5, 700.25, 701, 3.75, 999, 0});
  EXPECT_LT((line.at(wanted) - 2 * wanted).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Spline, StraightLineStaysStraight) {
  const VectorXd wanted = vector({0.01, 0.2, 0.77});
  EXPECT_LT((spline_at(kAt, 3 * kAt.array() - 1, wanted).array() - (3 * wanted.array() - 1))
                .abs()
                .maxCoeff(),
            1e-13);
}

TEST(Linear, LiesOnTheChords) {
  const VectorXd out = linear_at(kAt, kValue, vector({0, .05, .3, .65, .8}));
  EXPECT_LT((out - vector({1, 1.5, -1, 1.75, 3})).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(Interpolation, RefusesWhatItCannotKnow) {
  EXPECT_THROW(spline_at(kAt, kValue, vector({.9})), std::invalid_argument);
  EXPECT_THROW(linear_at(kAt, kValue, vector({-.1})), std::invalid_argument);
  EXPECT_THROW(linear_at(kAt, kValue.head(3), vector({.1})), std::invalid_argument);
  EXPECT_THROW(spline_at(vector({0, 1, 1}), vector({0, 1, 2}), vector({.1})),
               std::invalid_argument);
  EXPECT_THROW(spline_at(vector({0, 1}), vector({0, 1}), vector({.1})), std::invalid_argument);
}

}  // namespace
