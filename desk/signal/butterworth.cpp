#include "signal/butterworth.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>
#include <string>

namespace offnominal::desk {

std::vector<Biquad> butterworth_low_pass(int order, double cutoff_hz, double sample_rate_hz) {
  if (order < 2 || order % 2 != 0) {
    throw std::invalid_argument("Butterworth order " + std::to_string(order) +
                                ": an even number from 2 is allowed");
  }
  if (!(cutoff_hz > 0) || !(cutoff_hz < sample_rate_hz / 2)) {
    throw std::invalid_argument("cut-off " + std::to_string(cutoff_hz) +
                                " Hz: must lie between 0 and half the sampling rate of " +
                                std::to_string(sample_rate_hz) + " Hz");
  }
  const double k = std::tan(std::numbers::pi * cutoff_hz / sample_rate_hz);
  std::vector<Biquad> sections;
  for (int i = 0; i < order / 2; ++i) {
    const double angle = std::numbers::pi * (2 * i + 1) / (2 * order);
    const double inverse_q = 2 * std::cos(angle);
    const double a0 = 1 + k * inverse_q + k * k;
    Biquad section;
    section.b0 = k * k / a0;
    section.b1 = 2 * section.b0;
    section.b2 = section.b0;
    section.a1 = 2 * (k * k - 1) / a0;
    section.a2 = (1 - k * inverse_q + k * k) / a0;
    sections.push_back(section);
  }
  return sections;
}

}  // namespace offnominal::desk
