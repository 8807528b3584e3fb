#pragma once

#include <Eigen/Core>
#include <vector>

#include "signal/butterworth.hpp"

namespace offnominal::desk {

// The sections run forward, then backward: no phase, the gain squared (1/2 at a Butterworth
// cut-off). The signal is continued at both ends by `padding` samples, mirrored through its end
// points (odd extension), and each pass starts in the steady state of its first sample, so that a
// constant and the ends of a ramp pass unchanged. Same method as scipy.signal.sosfiltfilt.
// Throws std::invalid_argument unless 0 <= padding < signal.size(). NaN spreads over everything.
Eigen::VectorXd zero_phase(const std::vector<Biquad>& sections,
                           const Eigen::Ref<const Eigen::VectorXd>& signal, Eigen::Index padding);

// 4th-order Butterworth, forward and backward; the padding is three periods of the cut-off, or
// what the signal has. A cutoff at or above half the sampling rate returns the signal.
// Throws std::invalid_argument when cutoff_hz <= 0 or the signal is shorter than 2 samples.
Eigen::VectorXd zero_phase_low_pass(const Eigen::Ref<const Eigen::VectorXd>& signal,
                                    double cutoff_hz, double sample_rate_hz);

}  // namespace offnominal::desk
