#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <offnominal/diagnosis/isolation_block.hpp>
#include <offnominal/model/cholesky.hpp>
#include <offnominal/vector.hpp>

// Linear regression in information form, and what the evidence for it is. All regressors are scaled
// so that a parameter of 1 is a usual size of its fault (kPrior...): the prior of every parameter
// is N(0, 1). With y = x . theta + noise of variance 1,
//   G = sum x x^T,  g = sum x y,  theta = (G + I)^-1 g,
//   log p(y | x) - log p(y | nothing) = g . theta / 2 - log det(G + I) / 2,
// in which the second term is what more parameters have to pay (D. MacKay, Neural Computation 4,
// 1992).

namespace offnominal {

// How many times as large a large one is.
inline constexpr double kLargeFault = 5;
// How much smaller what the model lacks without a fault is: the threshold covers it.
inline constexpr double kPriorBaseline = 0.2;

template <int Size, typename Scalar>
struct Regression {
  Matrix<Size, Size, Scalar> gram = Matrix<Size, Size, Scalar>::Zero();  // G
  Vector<Size, Scalar> product = Vector<Size, Scalar>::Zero();           // g
};

// Takes y = x . theta + noise of variance 1 / weight.
template <int Size, typename Scalar>
void take(Regression<Size, Scalar>& sums, const Vector<Size, Scalar>& x, Scalar y, Scalar weight) {
  sums.gram += weight * x * x.transpose();
  sums.product += (weight * y) * x;
}

// What a regression has come to.
template <int Size, typename Scalar>
struct RegressionFit {
  Vector<Size, Scalar> theta = Vector<Size, Scalar>::Zero();
  Matrix<Size, Size, Scalar> covariance = Matrix<Size, Size, Scalar>::Identity();
  Scalar explained{};  // of the sum of squares, each over its variance
  Scalar evidence{};   // nats, against nothing
};

// With parameters of N(0, width^2).
template <int Size, typename Scalar>
[[nodiscard]] RegressionFit<Size, Scalar> fit_with(const Regression<Size, Scalar>& sums,
                                                   Scalar width) {
  Matrix<Size, Size, Scalar> information = sums.gram;
  for (int i = 0; i < Size; ++i) information(i, i) += 1 / (width * width);
  Matrix<Size, Size, Scalar> factor;
  RegressionFit<Size, Scalar> fit;
  if (!cholesky<Size, Scalar>(information, factor)) return fit;
  fit.theta = sums.product;
  solve_in_place<Size, Scalar>(factor, fit.theta);
  Scalar log_root{};
  for (int i = 0; i < Size; ++i) {
    fit.explained += sums.product[i] * fit.theta[i];
    log_root += std::log(width * factor(i, i));
    Vector<Size, Scalar> unit = Vector<Size, Scalar>::Zero();
    unit[i] = Scalar(1);
    solve_in_place<Size, Scalar>(factor, unit);
    fit.covariance.col(i) = unit;
  }
  fit.evidence = fit.explained / 2 - log_root;
  return fit;
}

// Nobody knows how large a fault is: the better of a usual size and a large one, half of the time
// each.
template <int Size, typename Scalar>
[[nodiscard]] RegressionFit<Size, Scalar> fit_of(const Regression<Size, Scalar>& sums) {
  constexpr auto kHalf = static_cast<Scalar>(-0.6931471805599453);  // log(1/2)
  const RegressionFit<Size, Scalar> usual = fit_with(sums, Scalar(1));
  const RegressionFit<Size, Scalar> large = fit_with(sums, static_cast<Scalar>(kLargeFault));
  RegressionFit<Size, Scalar> fit = large.evidence > usual.evidence ? large : usual;
  fit.evidence += kHalf;
  return fit;
}

// Of some of the parameters, the others 0.
template <int... Which, int Size, typename Scalar>
[[nodiscard]] Regression<static_cast<int>(sizeof...(Which)), Scalar> part_of(
    const Regression<Size, Scalar>& sums) {
  constexpr int kPart = sizeof...(Which);
  constexpr std::array<int, sizeof...(Which)> kWhich{Which...};
  Regression<kPart, Scalar> part;
  for (int i = 0; i < kPart; ++i) {
    const int row = kWhich[static_cast<std::size_t>(i)];
    part.product[i] = sums.product[row];
    for (int k = 0; k < kPart; ++k) {
      part.gram(i, k) = sums.gram(row, kWhich[static_cast<std::size_t>(k)]);
    }
  }
  return part;
}

// What the model lacks of one joint without a fault, learnt while there is none: friction, torque
// and offset that are a little other than the model says, and how large the rest is and how long it
// lasts. A joint that stands still is held by dry friction against torques that nobody knows: its
// rest is another one. Forgets exponentially, back to the prior.
template <typename Scalar>
struct JointBaseline {
  Regression<kOwnRegressors, Scalar> sums;
  std::array<Scalar, 2>
      variance{};  // of the rest, (N m)^2 or N^2: of a moving joint, of a still one
  // That the variances are worth, at most as many as are remembered.
  std::array<Scalar, 2> blocks{5, 5};
  Scalar
      correlation{};  // of the rests of two blocks that follow each other, each over its deviation
  Scalar last{};      // rest of the block before over its deviation
  Scalar largest_told{};  // torque of the drive, by size, N m or N
};

// What the baseline says of the next block.
template <typename Scalar>
struct BaselineRest {
  Scalar rest{};      // u without what the baseline expects, N m or N
  Scalar variance{};  // of that expectation
};

template <typename Scalar>
[[nodiscard]] BaselineRest<Scalar> rest_of(const JointBaseline<Scalar>& baseline,
                                           const Vector<kOwnRegressors, Scalar>& x, Scalar torque) {
  constexpr auto kInformation = static_cast<Scalar>(1 / (kPriorBaseline * kPriorBaseline));
  Matrix<kOwnRegressors, kOwnRegressors, Scalar> information = baseline.sums.gram;
  for (int i = 0; i < kOwnRegressors; ++i) information(i, i) += kInformation;
  Matrix<kOwnRegressors, kOwnRegressors, Scalar> factor;
  if (!cholesky<kOwnRegressors, Scalar>(information, factor)) return {torque, Scalar(0)};
  Vector<kOwnRegressors, Scalar> solved = x;
  solve_in_place<kOwnRegressors, Scalar>(factor, solved);
  Scalar expected{};
  Scalar variance{};
  for (int i = 0; i < kOwnRegressors; ++i) {
    expected += solved[i] * baseline.sums.product[i];
    variance += solved[i] * x[i];
  }
  return {torque - expected, variance};
}

// The same, 0 to 0.97.
template <typename Scalar>
[[nodiscard]] Scalar correlation_of(const JointBaseline<Scalar>& baseline) {
  return std::clamp(baseline.correlation, Scalar(0), Scalar(0.97));
}

// Takes a block of a healthy robot. `kept` < 1: of what was known before; `floor`: what the
// variance does not fall below.
template <typename Scalar>
void learn(JointBaseline<Scalar>& baseline, const Vector<kOwnRegressors, Scalar>& x, Scalar torque,
           bool still, Scalar kept, Scalar floor) {
  const std::size_t regime = still ? 1 : 0;
  const Scalar rest = rest_of(baseline, x, torque).rest;
  // Rests that last are one observation, not many.
  const Scalar correlation = correlation_of(baseline);
  Scalar& variance = baseline.variance[regime];
  baseline.sums.gram *= kept;
  baseline.sums.product *= kept;
  take(baseline.sums, x, torque, (1 - correlation) / ((1 + correlation) * variance));
  Scalar& blocks = baseline.blocks[regime];
  blocks = kept * blocks + 1;
  variance = std::max(floor, variance + (rest * rest - variance) / blocks);
  const Scalar now = rest / std::sqrt(variance);
  baseline.correlation +=
      (now * baseline.last - baseline.correlation) / (baseline.blocks[0] + baseline.blocks[1]);
  baseline.last = now;
}

// A torque on one joint that begins with the fault, lasts for about contact_s and is anything then:
// a scalar Kalman filter, and the evidence for it against nothing.
template <typename Scalar>
struct AnyTorque {
  Scalar torque{};    // N m or N
  Scalar variance{};  // of it
  Scalar evidence{};  // nats
  bool begun = false;
};

// y = torque + rest, whitened by y - correlation * y_before, of variance `noise`. `kept`: of the
// torque, from block to block; `prior`: its variance.
template <typename Scalar>
void take(AnyTorque<Scalar>& any, Scalar whitened, Scalar noise, Scalar correlation, Scalar kept,
          Scalar prior) {
  const Scalar driven = any.begun ? (1 - kept * kept) * prior : prior;
  any.begun = true;
  const Scalar seen = kept - correlation;  // of the torque before, in what is seen now
  const Scalar innovation = whitened - seen * any.torque;
  const Scalar spread = seen * seen * any.variance + driven + noise;
  const Scalar gain = (kept * seen * any.variance + driven) / spread;
  any.evidence +=
      (std::log(noise / spread) + whitened * whitened / noise - innovation * innovation / spread) /
      2;
  any.torque = kept * any.torque + gain * innovation;
  any.variance = kept * kept * any.variance + driven - gain * gain * spread;
}

}  // namespace offnominal
