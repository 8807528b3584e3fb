#include "signal/zero_phase.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace offnominal::desk {
namespace {

// One pass in place. The input of every section has settled at the first sample's value times the
// gain at 0 Hz of the sections before it.
void filter_from_steady_state(const std::vector<Biquad>& sections, Eigen::VectorXd& signal) {
  double level = signal[0];
  for (const Biquad& section : sections) {
    const double settled =
        level * (section.b0 + section.b1 + section.b2) / (1 + section.a1 + section.a2);
    double s1 = settled - section.b0 * level;
    double s2 = section.b2 * level - section.a2 * settled;
    for (double& value : signal) {
      const double in = value;
      value = section.b0 * in + s1;
      s1 = section.b1 * in - section.a1 * value + s2;
      s2 = section.b2 * in - section.a2 * value;
    }
    level = settled;
  }
}

}  // namespace

Eigen::VectorXd zero_phase(const std::vector<Biquad>& sections,
                           const Eigen::Ref<const Eigen::VectorXd>& signal, Eigen::Index padding) {
  const Eigen::Index size = signal.size();
  if (padding < 0 || padding >= size) {
    throw std::invalid_argument("padding must be at least 0 and less than the signal's length");
  }
  Eigen::VectorXd extended(size + 2 * padding);
  extended.segment(padding, size) = signal;
  for (Eigen::Index i = 1; i <= padding; ++i) {
    extended[padding - i] = 2 * signal[0] - signal[i];
    extended[padding + size - 1 + i] = 2 * signal[size - 1] - signal[size - 1 - i];
  }
  filter_from_steady_state(sections, extended);
  extended.reverseInPlace();
  filter_from_steady_state(sections, extended);
  extended.reverseInPlace();
  return extended.segment(padding, size);
}

Eigen::VectorXd zero_phase_low_pass(const Eigen::Ref<const Eigen::VectorXd>& signal,
                                    double cutoff_hz, double sample_rate_hz) {
  if (!(cutoff_hz > 0)) throw std::invalid_argument("the cut-off must be greater than 0 Hz");
  if (signal.size() < 2) throw std::invalid_argument("a signal to filter has at least 2 samples");
  if (cutoff_hz >= sample_rate_hz / 2) return signal;
  const double wanted = std::ceil(3 * sample_rate_hz / cutoff_hz);
  const auto longest = static_cast<double>(signal.size() - 1);
  return zero_phase(butterworth_low_pass(4, cutoff_hz, sample_rate_hz), signal,
                    static_cast<Eigen::Index>(std::min(wanted, longest)));
}

}  // namespace offnominal::desk
