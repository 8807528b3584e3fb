#include "signal/quantile.hpp"

#include <gtest/gtest.h>

namespace {

using Eigen::VectorXd;
using offnominal::desk::quantile;

TEST(Quantile, IsOneOfTheValues) {
  VectorXd values(5);
  values << 4, 1, 5, 2, 3;
  EXPECT_EQ(quantile(values, 0), 1);
  EXPECT_EQ(quantile(values, 0.5), 3);
  EXPECT_EQ(quantile(values, 0.99), 4);
  EXPECT_EQ(quantile(values, 1), 5);
  EXPECT_EQ(values[0], 4);  // the caller's are left alone
}

}  // namespace
