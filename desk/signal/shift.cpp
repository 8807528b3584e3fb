#include "signal/shift.hpp"

#include <algorithm>
#include <cmath>

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd ahead_by(const Eigen::Ref<const VectorXd>& signal, double samples) {
  const Index last = signal.size() - 1;
  if (last < 0 || samples == 0) return signal;
  const double limited = std::clamp(samples, -static_cast<double>(last), static_cast<double>(last));
  const auto whole = static_cast<Index>(std::floor(limited));
  const double part = limited - static_cast<double>(whole);
  const auto at = [&](Index k) { return signal[std::clamp<Index>(k, 0, last)]; };
  // Lagrange's polynomial through -1, 0, 1 and 2.
  const double before = -part * (part - 1) * (part - 2) / 6;
  const double here = (part + 1) * (part - 1) * (part - 2) / 2;
  const double next = -(part + 1) * part * (part - 2) / 2;
  const double after = (part + 1) * part * (part - 1) / 6;
  VectorXd shifted(signal.size());
  for (Index k = 0; k <= last; ++k) {
    const Index i = k + whole;
    shifted[k] = before * at(i - 1) + here * at(i) + next * at(i + 1) + after * at(i + 2);
  }
  return shifted;
}

}  // namespace offnominal::desk
