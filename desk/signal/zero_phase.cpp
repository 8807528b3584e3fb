#include "signal/zero_phase.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>

namespace offnominal::desk {
namespace {

// One pass in place over `count` values, the next one `step` further on. The input of every section
// has settled at `level` times the gain at 0 Hz of the sections before it; `level` is what leaves
// the last one then. Sections run side by side: each waits for its own last value alone.
template <std::size_t kSections>
void filter_by(const Biquad* sections, double& level, double* value, std::ptrdiff_t step,
               Eigen::Index count) {
  std::array<Biquad, kSections> of{};
  std::array<double, kSections> s1{};
  std::array<double, kSections> s2{};
  for (std::size_t k = 0; k < kSections; ++k) {
    of[k] = sections[k];
    const double settled = level * (of[k].b0 + of[k].b1 + of[k].b2) / (1 + of[k].a1 + of[k].a2);
    s1[k] = settled - of[k].b0 * level;
    s2[k] = of[k].b2 * level - of[k].a2 * settled;
    level = settled;
  }
  for (; count > 0; --count, value += step) {
    double passing = *value;
    for (std::size_t k = 0; k < kSections; ++k) {
      const double out = of[k].b0 * passing + s1[k];
      s1[k] = of[k].b1 * passing - of[k].a1 * out + s2[k];
      s2[k] = of[k].b2 * passing - of[k].a2 * out;
      passing = out;
    }
    *value = passing;
  }
}

// `step`: 1 from the first value to the last, -1 back.
void filter_from_steady_state(const std::vector<Biquad>& sections, Eigen::VectorXd& signal,
                              std::ptrdiff_t step) {
  double* const first = step > 0 ? signal.data() : signal.data() + signal.size() - 1;
  double level = *first;
  const Biquad* next = sections.data();
  const Biquad* const end = next + sections.size();
  for (; end - next >= 2; next += 2) filter_by<2>(next, level, first, step, signal.size());
  if (next != end) filter_by<1>(next, level, first, step, signal.size());
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
  filter_from_steady_state(sections, extended, 1);
  filter_from_steady_state(sections, extended, -1);
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
