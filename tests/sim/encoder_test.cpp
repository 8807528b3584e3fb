#include "offnominal/sim/encoder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "support/seed.hpp"

namespace offnominal::sim {
namespace {

TEST(Quantiser, RoundsToTheNearestStepMonotonicallyAndStaysThere) {
  auto generator = test::seeded_generator();
  std::uniform_real_distribution<double> value(-7.0, 7.0);
  std::uniform_int_distribution<int> bits(4, 24);
  for (int i = 0; i < 2000; ++i) {
    EncoderConfig config;
    config.bits_per_turn = bits(generator);
    const double step = position_step_rad(config);
    const double x = value(generator), y = value(generator);
    const double qx = quantise(x, step);
    EXPECT_LE(std::abs(qx - x), 0.5 * step * (1.0 + 1e-9));
    EXPECT_NEAR(qx / step, std::round(qx / step), 1e-6);
    EXPECT_EQ(quantise(qx, step), qx);
    EXPECT_EQ(quantise(-x, step), -qx);
    EXPECT_LE(quantise(std::min(x, y), step), quantise(std::max(x, y), step));
  }
}

TEST(Quantiser, OneTurnHasTwoToTheBitsCounts) {
  EncoderConfig config;
  config.bits_per_turn = 12;
  EXPECT_DOUBLE_EQ(position_step_rad(config) * 4096.0, 2.0 * std::numbers::pi);
}

TEST(Encoders, IdealSensorsReportTheTruth) {
  Encoders encoders({});
  const JointState truth{Eigen::Vector3d(0.123, -0.456, 0.789), Eigen::Vector3d(1.5, -2.5, 3.5)};
  const JointState measured = encoders.measure(truth, 0.001);
  EXPECT_EQ(measured.q, truth.q);
  EXPECT_EQ(measured.dq, truth.dq);
}

TEST(Encoders, QuantisedVelocityIsWithinHalfAStep) {
  EncoderConfig config;
  config.velocity = VelocitySource::kQuantised;
  config.velocity_step_rad_s = 0.01;
  Encoders encoders(config);
  const JointState measured =
      encoders.measure({Eigen::Vector2d(0.1, 0.2), Eigen::Vector2d(0.1234, -0.4567)}, 0.001);
  EXPECT_NEAR(measured.dq[0], 0.12, 1e-12);
  EXPECT_NEAR(measured.dq[1], -0.46, 1e-12);
}

TEST(Encoders, BackwardDifferenceOfAConstantSpeedIsOffByAtMostOneCount) {
  EncoderConfig config;
  config.bits_per_turn = 14;
  config.velocity = VelocitySource::kBackwardDifference;
  Encoders encoders(config);
  const double period = 0.002, count_per_period = position_step_rad(config) / period;
  const Eigen::Vector2d dq(0.7, -1.1);
  double sum = 0.0;
  for (int k = 0; k < 1000; ++k) {
    const JointState measured = encoders.measure({k * period * dq, dq}, period);
    for (int j = 0; j < 2; ++j) {
      EXPECT_LE(std::abs(measured.dq[j] - dq[j]), count_per_period * (1.0 + 1e-9));
      const double counts = measured.dq[j] / count_per_period;
      EXPECT_NEAR(counts, std::round(counts), 1e-6) << "counts come whole";
    }
    sum += measured.dq[0];
  }
  EXPECT_NEAR(sum / 1000.0, dq[0], count_per_period / 500.0);
}

TEST(Encoders, RefusesWrongFields) {
  const auto make = [](int bits, VelocitySource velocity, double step) {
    return Encoders({bits, velocity, step});
  };
  EXPECT_THROW(make(-1, VelocitySource::kIdeal, 0.0), std::invalid_argument);
  EXPECT_THROW(make(53, VelocitySource::kIdeal, 0.0), std::invalid_argument);
  EXPECT_THROW(make(0, VelocitySource::kQuantised, 0.0), std::invalid_argument);
  EXPECT_THROW(make(0, VelocitySource::kQuantised, std::nan("")), std::invalid_argument);
  Encoders ideal({});
  EXPECT_THROW(static_cast<void>(ideal.measure({}, 0.0)), std::invalid_argument);
}

}  // namespace
}  // namespace offnominal::sim
