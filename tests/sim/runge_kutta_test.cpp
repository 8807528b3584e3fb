#include "offnominal/sim/runge_kutta.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "offnominal/sim/two_link_plant.hpp"

namespace offnominal::sim {
namespace {

double error_of_forced_decay(int steps) {
  // x' = -2 x + cos 3t, x(0) = 1.
  const auto derivative = [](double t, double x) { return -2.0 * x + std::cos(3.0 * t); };
  const auto exact = [](double t) {
    return (2.0 * std::cos(3.0 * t) + 3.0 * std::sin(3.0 * t) + 11.0 * std::exp(-2.0 * t)) / 13.0;
  };
  const double h = 2.0 / steps;
  double x = 1.0;
  for (int i = 0; i < steps; ++i) x = runge_kutta4_step(i * h, x, h, derivative);
  return std::abs(x - exact(2.0));
}

TEST(RungeKutta, HalvingTheStepDividesTheErrorBySixteen) {
  for (const int steps : {60, 120, 240}) {
    const double ratio = error_of_forced_decay(steps) / error_of_forced_decay(2 * steps);
    EXPECT_GT(ratio, 14.0) << steps;
    EXPECT_LT(ratio, 18.0) << steps;
  }
}

// Swings freely under a smooth uncertainty; sgn(dq1) of the paper's friction is not smooth.
TwoLinkState swing(int substeps) {
  const Uncertainty smooth = [](double t, const TwoLinkState& s) -> Eigen::Vector2d {
    return 0.3 * s.dq + Eigen::Vector2d::Constant(0.5 * std::sin(5.0 * t));
  };
  const TwoLinkPlant plant({}, {}, smooth);
  return plant.step(0.0, {{0.3, -0.4}, {0.5, 1.0}}, {20.0, 5.0}, 0.8, substeps);
}

TEST(RungeKutta, PlantStepIsOfOrderFour) {
  const auto distance = [](const TwoLinkState& a, const TwoLinkState& b) {
    return std::hypot((a.q - b.q).norm(), (a.dq - b.dq).norm());
  };
  const TwoLinkState reference = swing(12800);
  for (const int substeps : {100, 200, 400}) {
    const double ratio =
        distance(swing(substeps), reference) / distance(swing(2 * substeps), reference);
    EXPECT_GT(ratio, 14.0) << substeps;
    EXPECT_LT(ratio, 18.0) << substeps;
  }
}

}  // namespace
}  // namespace offnominal::sim
