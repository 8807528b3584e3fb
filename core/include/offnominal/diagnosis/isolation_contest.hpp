#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <offnominal/diagnosis/fault_kind.hpp>

namespace offnominal {

// The best of the hypotheses and the sum over all, in one way through them.
template <typename Scalar>
struct Contest {
  FaultKind kind = FaultKind::kUnknown;
  std::uint8_t joint = 0;
  Scalar best = -std::numeric_limits<Scalar>::infinity();  // log of prior times evidence
  Scalar total = Scalar(0);                                // of all, over that of the best

  void enter(FaultKind of, std::size_t on, Scalar logarithm) {
    if (logarithm > best) {
      total = total * std::exp(best - logarithm) + Scalar(1);
      best = logarithm;
      kind = of;
      joint = static_cast<std::uint8_t>(on);
    } else {
      total += std::exp(logarithm - best);
    }
  }
  [[nodiscard]] Scalar share() const { return Scalar(1) / total; }
};

}  // namespace offnominal
