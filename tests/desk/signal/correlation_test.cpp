#include "signal/correlation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace {

using Eigen::Index;
using Eigen::VectorXd;
using offnominal::desk::correlation_samples;

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
