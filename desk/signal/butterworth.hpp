#pragma once

#include <vector>

namespace offnominal::desk {

// One second-order section, direct form II transposed, a0 = 1:
//   y[k] = b0 x[k] + s1,  s1 <- b1 x[k] - a1 y[k] + s2,  s2 <- b2 x[k] - a2 y[k].
struct Biquad {
  double b0 = 1;
  double b1 = 0;
  double b2 = 0;
  double a1 = 0;
  double a2 = 0;
};

// Butterworth low-pass of even order as order/2 sections, lowest quality factor first, by the
// bilinear transform with the cut-off prewarped. Gain 1 at 0 Hz and 1/sqrt(2) at cutoff_hz.
// Throws std::invalid_argument unless order is even and positive and
// 0 < cutoff_hz < sample_rate_hz / 2.
std::vector<Biquad> butterworth_low_pass(int order, double cutoff_hz, double sample_rate_hz);

}  // namespace offnominal::desk
