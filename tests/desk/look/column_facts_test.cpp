#include "look/column_facts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using Eigen::Index;
using Eigen::VectorXd;
using offnominal::desk::ColumnFacts;
using offnominal::desk::facts_of;

VectorXd wave(Index samples) {
  VectorXd x(samples);
  for (Index i = 0; i < samples; ++i) x[i] = std::sin(0.01 * static_cast<double>(i));
  return x;
}

TEST(ColumnFacts, AnEncodersStepIsTheOneThatAllChangesShare) {
  const double step = 6.283185307179586 / 4096;
  VectorXd x = wave(2000);
  for (double& v : x) v = step * std::round(v / step);
  const ColumnFacts facts = facts_of(x);
  EXPECT_NEAR(facts.step, step, 1e-9);
  EXPECT_FALSE(facts.is_printed);
}

TEST(ColumnFacts, FloatsHaveNoStepAndDigitsAreSaidToBeDigits) {
  EXPECT_EQ(facts_of(wave(2000)).step, 0);
  VectorXd x = wave(2000);
  for (double& v : x) v = std::round(v * 1e5) / 1e5;
  const ColumnFacts facts = facts_of(x);
  EXPECT_NEAR(facts.step, 1e-5, 1e-10);
  EXPECT_TRUE(facts.is_printed);
}

TEST(ColumnFacts, RestAndSaturationAreSharesOfTheSamples) {
  VectorXd x = 2 * wave(4000);
  x.head(1000).setConstant(x[0]);
  EXPECT_NEAR(facts_of(x).resting_share, 0.25, 0.05);
  const VectorXd clipped = x.cwiseMin(1.5).cwiseMax(-1.7);
  const ColumnFacts facts = facts_of(clipped);
  const double held = static_cast<double>((clipped.array() == 1.5).count()) / 4000;
  EXPECT_GT(held, 0.1);
  EXPECT_NEAR(facts.held_at_high, held, 1e-9);
  EXPECT_GT(facts.held_at_low, 0.05);
  EXPECT_EQ(facts_of(wave(4000)).held_at_high, 0);
}

TEST(ColumnFacts, WhatIsNotFiniteIsCountedAndLeftOut) {
  VectorXd x = wave(300);
  x[7] = std::nan("");
  x[8] = std::numeric_limits<double>::infinity();
  const ColumnFacts facts = facts_of(x);
  EXPECT_EQ(facts.not_finite, 2);
  EXPECT_LE(facts.high, 1);
  EXPECT_TRUE(facts_of(VectorXd::Constant(9, 4)).is_constant);
  EXPECT_EQ(facts_of(VectorXd::Constant(3, std::nan(""))).not_finite, 3);
  EXPECT_EQ(facts_of(VectorXd()).values, 0);
}

}  // namespace
