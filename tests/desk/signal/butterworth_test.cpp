#include "signal/butterworth.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

namespace {

using offnominal::desk::Biquad;
using offnominal::desk::butterworth_low_pass;

double gain_at(const std::vector<Biquad>& sections, double frequency_hz, double sample_rate_hz) {
  const std::complex<double> z =
      std::polar(1.0, -2 * std::numbers::pi * frequency_hz / sample_rate_hz);
  std::complex<double> response = 1;
  for (const Biquad& s : sections) {
    response *= (s.b0 + s.b1 * z + s.b2 * z * z) / (1.0 + s.a1 * z + s.a2 * z * z);
  }
  return std::abs(response);
}

TEST(Butterworth, GainFollowsTheClosedFormAtEveryFrequency) {
  for (const int order : {2, 4, 6}) {
    for (const double cutoff : {5.0, 100.0, 400.0}) {
      const auto sections = butterworth_low_pass(order, cutoff, 1000);
      for (const double frequency : {0.0, 1.0, 50.0, 99.0, 250.0, 480.0}) {
        const double ratio = std::tan(std::numbers::pi * frequency / 1000) /
                             std::tan(std::numbers::pi * cutoff / 1000);
        EXPECT_NEAR(gain_at(sections, frequency, 1000),
                    1 / std::sqrt(1 + std::pow(ratio, 2 * order)), 1e-11)
            << order << " " << cutoff << " " << frequency;
      }
    }
  }
}

TEST(Butterworth, GainIsThreeDecibelsDownAtTheCutOffAndOneAtRest) {
  const auto sections = butterworth_low_pass(4, 40, 1000);
  EXPECT_NEAR(gain_at(sections, 40, 1000), std::sqrt(0.5), 1e-13);
  EXPECT_NEAR(gain_at(sections, 0, 1000), 1, 1e-11);
}

// scipy 1.10.1: scipy.signal.butter(4, 100, fs=1000, output='sos'); the gain of its first section
// (b0 = 0.00482434335771623) is shared out over both sections here.
TEST(Butterworth, SectionsEqualScipy) {
  const auto sections = butterworth_low_pass(4, 100, 1000);
  ASSERT_EQ(sections.size(), 2U);
  EXPECT_NEAR(sections[0].b0 * sections[1].b0, 0.00482434335771623, 1e-15);
  EXPECT_NEAR(sections[0].a1, -1.0485995763626117, 1e-13);
  EXPECT_NEAR(sections[0].a2, 0.2961403575616696, 1e-13);
  EXPECT_NEAR(sections[1].a1, -1.320913430819426, 1e-13);
  EXPECT_NEAR(sections[1].a2, 0.6327387928852762, 1e-13);
  EXPECT_NEAR(sections[0].b1, 2 * sections[0].b0, 1e-16);
}

TEST(Butterworth, RefusesWhatIsNoLowPass) {
  EXPECT_THROW(butterworth_low_pass(3, 10, 1000), std::invalid_argument);
  EXPECT_THROW(butterworth_low_pass(0, 10, 1000), std::invalid_argument);
  EXPECT_THROW(butterworth_low_pass(4, 0, 1000), std::invalid_argument);
  EXPECT_THROW(butterworth_low_pass(4, 500, 1000), std::invalid_argument);
  EXPECT_THROW(butterworth_low_pass(4, std::nan(""), 1000), std::invalid_argument);
  EXPECT_THROW(butterworth_low_pass(4, 10, -1000), std::invalid_argument);
}

}  // namespace
