#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <offnominal/repeat.hpp>
#include <offnominal/vector.hpp>

namespace offnominal {

enum class DeadZone : std::uint8_t {
  kContinuous = 0,     // e (1 - mu / |e|) outside, the paper's remark 3.4
  kDiscontinuous = 1,  // e outside, the paper's own
};

// D[e] of the learning law (7): 0 while |e| <= mu (Euclidean norm), otherwise the error, shrunk by
// mu where continuous. At e = mu = 0 it is 0. mu >= 0; e and mu in rad/s or m/s. |D[e]| does not
// exceed `largest`, and an error whose norm the scalar cannot hold gives 0.
template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> dead_zone(const Vector<N, Scalar>& e, Scalar mu, DeadZone kind,
                                          Scalar largest = std::numeric_limits<Scalar>::max()) {
  const Scalar norm = detail::length(e);
  const Scalar inverse = Scalar(1) / Eigen::numext::maxi(norm, std::numeric_limits<Scalar>::min());
  const Scalar shrunk = kind == DeadZone::kContinuous ? Scalar(1) - mu * inverse : Scalar(1);
  const Scalar limited = Eigen::numext::mini(shrunk, largest * inverse);
  const Scalar factor = norm > mu ? Eigen::numext::maxi(limited, Scalar(0)) : Scalar(0);
  return factor * e;
}

// The same joint by joint, for thresholds of their own: component i is 0 while |e_i| <= mu_i.
template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> dead_zone(const Vector<N, Scalar>& e, const Vector<N, Scalar>& mu,
                                          DeadZone kind,
                                          Scalar largest = std::numeric_limits<Scalar>::max()) {
  Vector<N, Scalar> outside;
  outside.resize(e.size());
  const Scalar taken = kind == DeadZone::kContinuous ? Scalar(1) : Scalar(0);
  detail::repeat<N>(
      e.size(), [&](int i) __attribute__((always_inline)) {
        const Scalar size = Eigen::numext::abs(e[i]);
        const Scalar beyond = size - taken * mu[i];
        const Scalar signed_beyond = e[i] < Scalar(0) ? -beyond : beyond;
        outside[i] = size > mu[i] ? signed_beyond : Scalar(0);
      });
  const Scalar norm =
      Eigen::numext::maxi(detail::length(outside), std::numeric_limits<Scalar>::min());
  return Eigen::numext::mini(Scalar(1), largest / norm) * outside;
}

}  // namespace offnominal
