#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <offnominal/finite.hpp>
#include <offnominal/model/cholesky.hpp>
#include <offnominal/model/rigid_body_model.hpp>
#include <offnominal/status.hpp>

namespace offnominal {

enum class BoundKind : std::uint8_t {
  kConstant = 0,    // offset
  kScaledNorm = 1,  // scale * (|A dq| + offset)
  kTable = 2,       // linear between points over one variable
};

enum class BoundVariable : std::uint8_t {
  kPosition = 0,  // q, rad or m
  kSpeed = 1,     // |dq|, rad/s or m/s
  kTorque = 2,    // |tau|, N m or N
};

inline constexpr int kMaxTablePoints = 16;

// mu_bar(q, dq, tau) of assumption 3.1: what |M^-1 (unmodelled torque)| does not exceed, rad/s^2
// (m/s^2). Only its low-pass filtered value is compared with the filtered uncertainty, so a bound
// may be exceeded for an instant (docs/theory.md, erratum 6). Plain data; one kind is in use.
template <int N, typename Scalar>
struct UncertaintyBound {
  BoundKind kind = BoundKind::kConstant;
  // Largest error of the measured velocity, Euclidean norm over the joints, rad/s or m/s, >= 0. It
  // raises the threshold by twice its size (docs/theory.md); evaluate() leaves it out.
  Scalar velocity_error{};
  Scalar offset = 1;  // > 0 for kConstant, >= 0 for kScaledNorm
  Scalar scale = 1;   // > 0
  // A, row by row; rows that are not needed stay zero. |.| is the Euclidean norm.
  PerJointPair<N, Scalar> matrix{};
  // kTable: abscissae strictly rising, values > 0, the end values hold beyond both ends.
  BoundVariable variable = BoundVariable::kSpeed;
  std::uint8_t joint = 0;
  std::uint8_t points = 0;
  std::array<Scalar, kMaxTablePoints> at{};
  std::array<Scalar, kMaxTablePoints> value{};
};

namespace detail {

template <int N, typename Scalar>
[[nodiscard]] bool table_valid(const UncertaintyBound<N, Scalar>& bound, std::size_t joints) {
  if (bound.points < 1 || bound.points > kMaxTablePoints || bound.joint >= joints) return false;
  for (std::size_t i = 0; i < bound.points; ++i) {
    if (!is_finite(bound.at[i]) || !is_finite(bound.value[i]) || bound.value[i] <= 0) {
      return false;
    }
    if (i > 0 && bound.at[i] <= bound.at[i - 1]) return false;
  }
  return true;
}

template <int N, typename Scalar>
[[nodiscard]] Scalar table_value(const UncertaintyBound<N, Scalar>& bound, Scalar x) {
  Scalar result = bound.value[0];
  for (std::size_t i = 1; i < bound.points; ++i) {
    const Scalar part = (x - bound.at[i - 1]) / (bound.at[i] - bound.at[i - 1]);
    const Scalar inside = std::clamp(part, Scalar(0), Scalar(1));
    result += inside * (bound.value[i] - bound.value[i - 1]);
  }
  return result;
}

}  // namespace detail

// For a chain of `joints` joints. kWrongJointCount: the matrix in use is one of other joints.
template <int N, typename Scalar>
[[nodiscard]] Status validate(const UncertaintyBound<N, Scalar>& bound,
                              std::size_t joints = static_cast<std::size_t>(N)) {
  const auto require = [](bool good) { return good ? Status::kOk : Status::kInvalidBound; };
  if (!is_finite(bound.velocity_error) || bound.velocity_error < 0) {
    return Status::kInvalidBound;
  }
  switch (bound.kind) {
    case BoundKind::kConstant:
      return require(is_finite(bound.offset) && bound.offset > 0);
    case BoundKind::kScaledNorm: {
      if constexpr (N == kRuntimeJoints) {
        const bool fits = joints > 0 && bound.matrix.size() == joints * joints;
        if (!fits) return Status::kWrongJointCount;
      }
      const bool good =
          is_finite(bound.scale) && bound.scale > 0 && is_finite(bound.offset) && bound.offset >= 0;
      return require(good && all_finite(bound.matrix));
    }
    case BoundKind::kTable:
      return require(detail::table_valid(bound, joints));
  }
  return Status::kInvalidBound;
}

// mu_bar at one instant, rad/s^2 (m/s^2), >= 0 for a valid bound; NaN in, NaN out.
template <int N, typename Scalar>
[[nodiscard]] Scalar evaluate(const UncertaintyBound<N, Scalar>& bound, const Vector<N, Scalar>& q,
                              const Vector<N, Scalar>& dq, const Vector<N, Scalar>& tau) {
  switch (bound.kind) {
    case BoundKind::kConstant:
      return bound.offset;
    case BoundKind::kScaledNorm: {
      constexpr int kMost = kMostJoints<N>;
      using RowMajor =
          Eigen::Matrix<Scalar, N, N, N == 1 ? Eigen::ColMajor : Eigen::RowMajor, kMost, kMost>;
      const Eigen::Map<const RowMajor> a(bound.matrix.data(), dq.size(), dq.size());
      return bound.scale * (detail::length(product<N, Scalar>(a, dq)) + bound.offset);
    }
    case BoundKind::kTable: {
      const auto joint = static_cast<Eigen::Index>(bound.joint);
      const Scalar x = bound.variable == BoundVariable::kPosition ? q[joint]
                       : bound.variable == BoundVariable::kSpeed  ? Eigen::numext::abs(dq[joint])
                                                                  : Eigen::numext::abs(tau[joint]);
      return detail::table_value(bound, x);
    }
  }
  return Scalar(0);
}

}  // namespace offnominal
