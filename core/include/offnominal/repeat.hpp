#pragma once

#include <Eigen/Core>
#include <utility>

namespace offnominal::detail {

// body(0) .. body(Count - 1), written out: without vector instructions the bookkeeping of a loop
// costs as much as its work.
template <int Count, typename Body>
EIGEN_ALWAYS_INLINE void repeat(const Body& body) {
  const auto all = [&]<int... I>(std::integer_sequence<int, I...>) __attribute__((always_inline)) {
    (body(I), ...);
  };
  all(std::make_integer_sequence<int, Count>{});
}

// The same, where Count may be no number (kRuntimeJoints, and less): then body(0) .. body(count -
// 1) in a loop.
template <int Count, typename Body>
EIGEN_ALWAYS_INLINE void repeat([[maybe_unused]] Eigen::Index count, const Body& body) {
  if constexpr (Count < 0) {
    for (int i = 0; i < static_cast<int>(count); ++i) body(i);
  } else {
    repeat<Count>(body);
  }
}

}  // namespace offnominal::detail
