#include "signal/zero_phase.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace {

using Eigen::Index;
using Eigen::VectorXd;
using offnominal::desk::butterworth_low_pass;
using offnominal::desk::zero_phase;
using offnominal::desk::zero_phase_low_pass;

VectorXd sine(Index size, double frequency_hz, double sample_rate_hz) {
  const auto k = VectorXd::LinSpaced(size, 0, static_cast<double>(size - 1));
  return (2 * std::numbers::pi * frequency_hz / sample_rate_hz * k).array().sin();
}

// Amplitude and phase of the part at frequency_hz, away from the ends, over whole periods.
std::array<double, 2> amplitude_and_phase(const VectorXd& signal, double frequency_hz,
                                          double sample_rate_hz, Index from, Index size) {
  double in_phase = 0;
  double quadrature = 0;
  for (Index k = from; k < from + size; ++k) {
    const double angle =
        2 * std::numbers::pi * frequency_hz / sample_rate_hz * static_cast<double>(k);
    in_phase += signal[k] * std::sin(angle);
    quadrature += signal[k] * std::cos(angle);
  }
  const double scale = 2 / static_cast<double>(size);
  return {scale * std::hypot(in_phase, quadrature), std::atan2(quadrature, in_phase)};
}

TEST(ZeroPhase, SineAtTheCutOffIsHalvedWithoutPhase) {
  const VectorXd out = zero_phase_low_pass(sine(6000, 40, 1000), 40, 1000);
  const auto [amplitude, phase] = amplitude_and_phase(out, 40, 1000, 2000, 2000);
  EXPECT_NEAR(20 * std::log10(amplitude), -6.0206, 1e-4);
  EXPECT_NEAR(phase, 0, 1e-9);
}

TEST(ZeroPhase, SineBelowTheCutOffFollowsTheSquaredGain) {
  const VectorXd out = zero_phase_low_pass(sine(6000, 20, 1000), 40, 1000);
  const auto [amplitude, phase] = amplitude_and_phase(out, 20, 1000, 2000, 2000);
  const double ratio = std::tan(std::numbers::pi * 0.02) / std::tan(std::numbers::pi * 0.04);
  EXPECT_NEAR(amplitude, 1 / (1 + std::pow(ratio, 8)), 1e-9);
  EXPECT_NEAR(phase, 0, 1e-9);
}

TEST(ZeroPhase, ConstantPassesUnchanged) {
  const VectorXd out = zero_phase_low_pass(VectorXd::Constant(200, 7.25), 3, 100);
  EXPECT_LT((out.array() - 7.25).abs().maxCoeff(), 1e-10);
}

TEST(ZeroPhase, RampKeepsItsEnds) {
  const VectorXd ramp = VectorXd::LinSpaced(1000, -2, 5);
  const VectorXd out = zero_phase_low_pass(ramp, 40, 1000);
  EXPECT_LT((out - ramp).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(ZeroPhase, IsLinear) {
  const VectorXd a = sine(500, 3, 100);
  const VectorXd b = sine(500, 17, 100);
  const VectorXd sum = 2 * a - 3 * b;
  const VectorXd expected =
      2 * zero_phase_low_pass(a, 10, 100) - 3 * zero_phase_low_pass(b, 10, 100);
  EXPECT_LT((zero_phase_low_pass(sum, 10, 100) - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(ZeroPhase, ReversedInputGivesReversedOutputAwayFromTheEnds) {
  VectorXd signal = sine(3000, 7, 1000);
  signal.segment(1400, 100).array() += 1;
  const VectorXd forward = zero_phase_low_pass(signal, 40, 1000);
  const VectorXd backward = zero_phase_low_pass(signal.reverse(), 40, 1000).reverse();
  EXPECT_LT((forward - backward).segment(500, 2000).cwiseAbs().maxCoeff(), 1e-9);
}

// scipy 1.10.1, numpy n = arange(40):
//   sosfiltfilt(butter(4, 100, fs=1000, output='sos'), sin(.3 n) + .5 (n > 20) + .01 n, padlen=30)
TEST(ZeroPhase, EqualsScipy) {
  VectorXd signal(40);
  for (Index n = 0; n < 40; ++n) {
    signal[n] = std::sin(0.3 * static_cast<double>(n)) + (n > 20 ? 0.5 : 0.0) +
                0.01 * static_cast<double>(n);
  }
  const VectorXd out = zero_phase(butterworth_low_pass(4, 100, 1000), signal, 30);
  EXPECT_NEAR(out[0], -1.4959612887966919e-04, 1e-12);
  EXPECT_NEAR(out[1], 3.0456261232033544e-01, 1e-12);
  EXPECT_NEAR(out[10], 2.5123127614320029e-01, 1e-12);
  EXPECT_NEAR(out[20], 1.1938524152690352e-01, 1e-12);
  EXPECT_NEAR(out[21], 5.2618253479407651e-01, 1e-12);
  EXPECT_NEAR(out[39], 1.2774998803671167e-01, 1e-12);
}

TEST(ZeroPhase, CutOffBeyondHalfTheSamplingRateChangesNothing) {
  const VectorXd signal = sine(100, 3, 100);
  EXPECT_EQ(zero_phase_low_pass(signal, 50, 100), signal);
}

TEST(ZeroPhase, RefusesPaddingBeyondTheSignal) {
  const auto sections = butterworth_low_pass(4, 10, 100);
  EXPECT_THROW(zero_phase(sections, VectorXd::Zero(10), 10), std::invalid_argument);
  EXPECT_THROW(zero_phase(sections, VectorXd::Zero(10), -1), std::invalid_argument);
  EXPECT_THROW(zero_phase_low_pass(VectorXd::Zero(1), 10, 100), std::invalid_argument);
  EXPECT_THROW(zero_phase_low_pass(VectorXd::Zero(10), 0, 100), std::invalid_argument);
}

}  // namespace
