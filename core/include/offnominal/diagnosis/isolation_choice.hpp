#pragma once

#include <offnominal/diagnosis/isolation.hpp>

// Whether a controller asks after a detection which fault it is, as a policy: WithIsolation, in
// torque space alone, or WithoutIsolation, which costs nothing.

namespace offnominal {

struct WithoutIsolation {
  template <int N, typename Scalar>
  struct Of {
    struct State {};
  };
};
struct WithIsolation {
  template <int N, typename Scalar>
  using Of = Isolation<N, Scalar>;
};

}  // namespace offnominal
