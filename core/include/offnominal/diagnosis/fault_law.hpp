#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <offnominal/diagnosis/isolation_block.hpp>
#include <offnominal/model/smooth_sign.hpp>
#include <offnominal/vector.hpp>

// What a fault that has been named does to the joints now. The law of its kind says how that
// changes with the motion, at once, with the numbers that were found of it; what the monitor sees
// says how much the law misses, one filter's time later. Together, of the torque u beside the
// model:
//   load = law + missed,  missed = W_alpha(u - law) = alpha e + W_alpha(psi_hat) - W_alpha(law)
// (docs/theory.md, "Compensation by the law of the fault"). The law of a body is that of one that
// is not accelerated: a torque that follows the acceleration, which the drives themselves make,
// would be a loop of its own. What is seen of it is told from what is missed without it,
// W_alpha(p') = alpha (p - W_alpha(p)).

namespace offnominal {

template <int N, typename Scalar>
struct FaultLaw {
  bool known = false;      // there is one, and what is seen goes with it
  bool of_body = false;    // on the last link: acts on every joint, otherwise on `joint` alone
  std::uint8_t joint = 0;  // from 0
  Scalar sign_width{};     // over which dry friction changes its sign, rad/s or m/s
  // Per unit of each regressor: N m or N, N m s/rad or N s/m, share, N m or N.
  Vector<kOwnRegressors, Scalar> own = Vector<kOwnRegressors, Scalar>::Zero();
  Vector<kTipParameters, Scalar> body = Vector<kTipParameters, Scalar>::Zero();  // kg, kg m
  Vector<N, Scalar> seen_of_law = zeros<N, Scalar>();     // W_alpha(law), N m or N
  Vector<N, Scalar> seen_of_learnt = zeros<N, Scalar>();  // W_alpha(psi_hat), N m or N
  Vector<N, Scalar> momentum = zeros<N, Scalar>();        // W_alpha(p) of the body, N m s or N s
  // Means over kDoubtS, each over the joint's threshold squared and, so that a large law says as
  // much as a larger one, one more than the first: of what is seen of the law, squared, and of what
  // acts along it. Where they are the same the law is right in the mean.
  Scalar law_squared{};
  Scalar acting_by_law{};
  Vector<N, Scalar> load = zeros<N, Scalar>();  // what acts on the joints, N m or N
};

// Constants of a monitor, per tick.
template <typename Scalar>
struct LawRates {
  Scalar alpha{};   // 1/s
  Scalar filter{};  // 1 - exp(-alpha period)
  Scalar doubt{};   // of the means
};

namespace detail {

// Where less than this share of the law acts, in the mean over kDoubtS, it holds no more: the fault
// is over, or another. What the model's own error adds does not go with the law.
inline constexpr double kLeastActing = 0.3;
inline constexpr double kDoubtS = 1;

template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> torque_of(const FaultLaw<N, Scalar>& law,
                                          const IsolationInstant<N, Scalar>& at) {
  if (law.of_body) return at.tip.pull.transpose().lazyProduct(law.body);
  Vector<N, Scalar> torque = zeros<N, Scalar>(at.residual.size());
  const auto column = static_cast<Eigen::Index>(law.joint);
  Vector<kOwnRegressors, Scalar> own = at.own.col(column);
  own[kSignRegressor] = smooth_sign(own[kVelocityRegressor], law.sign_width);
  torque[column] = own.dot(law.own);
  return torque;
}

// The body's momentum, of a joint's own fault nothing.
template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> momentum_of(const FaultLaw<N, Scalar>& law,
                                            const IsolationInstant<N, Scalar>& at) {
  return at.tip.momentum.transpose().lazyProduct(law.body);
}

// Of a joint's own fault, N m or N: of dry friction also where the joint creeps or sticks.
template <int N, typename Scalar>
[[nodiscard]] Scalar size_of(const FaultLaw<N, Scalar>& law,
                             const IsolationInstant<N, Scalar>& at) {
  const auto column = static_cast<Eigen::Index>(law.joint);
  Vector<kOwnRegressors, Scalar> own = at.own.col(column);
  own[kSignRegressor] = Scalar(1);
  return own.cwiseProduct(law.own).template lpNorm<1>();
}

// The load, and whether the law still holds.
template <int N, typename Scalar>
void take_torque(const Vector<N, Scalar>& torque, const Vector<N, Scalar>& accelerated,
                 const IsolationInstant<N, Scalar>& at, const PerJoint<N, Scalar>& thresholds,
                 Scalar doubt, FaultLaw<N, Scalar>& law) {
  const Scalar size = size_of(law, at);
  Scalar squared{};
  Scalar acting{};
  // A joint that is not the fault's: what was learnt of it, nothing before it has been detected.
  law.load = at.psi_hat;
  for (Eigen::Index i = 0; i < torque.size(); ++i) {
    if (!law.of_body && i != static_cast<Eigen::Index>(law.joint)) continue;
    const Scalar threshold = thresholds[static_cast<std::size_t>(i)];
    const Scalar missed = at.residual[i] + law.seen_of_learnt[i] - law.seen_of_law[i];
    // Within the size of the fault, and what a healthy joint may show: beyond, it may be anything.
    const Scalar most = threshold + (law.of_body ? Eigen::numext::abs(torque[i]) : size) +
                        Eigen::numext::abs(accelerated[i]);
    law.load[i] = torque[i] + std::clamp(missed, -most, most);
    const Scalar of_law = (law.seen_of_law[i] - accelerated[i]) / threshold;
    const Scalar of_all = (at.residual[i] + law.seen_of_learnt[i]) / threshold;
    squared += of_law * of_law;
    acting += of_law * of_all;
  }
  // While there is nothing of the law, at rest say, nothing can be said against it.
  constexpr auto kLittle = Scalar(0.1);  // of a threshold
  if (squared < kLittle * kLittle) return;
  const Scalar per_square = 1 / (1 + squared);
  law.law_squared += doubt * (per_square * squared - law.law_squared);
  law.acting_by_law += doubt * (per_square * acting - law.acting_by_law);
  law.known = law.acting_by_law >= static_cast<Scalar>(kLeastActing) * law.law_squared;
}

}  // namespace detail

// Starts at the tick that names the fault, as if the law had been right until then. `thresholds`,
// N m or N, above 0: the largest of each joint.
template <int N, typename Scalar>
void begin_law(const IsolationInstant<N, Scalar>& at, const PerJoint<N, Scalar>& thresholds,
               FaultLaw<N, Scalar>& law) {
  law.seen_of_learnt = at.psi_hat;
  law.seen_of_law = at.residual + at.psi_hat;
  law.momentum = detail::momentum_of(law, at);
  const Vector<N, Scalar> accelerated = Scalar(0) * law.momentum;
  detail::take_torque(detail::torque_of(law, at), accelerated, at, thresholds, Scalar(1), law);
}

// Takes the monitor's next tick; those that it had none of it has not filtered either. Clears
// `known` for good where the law is seen to hold no more.
template <int N, typename Scalar>
void follow_law(const IsolationInstant<N, Scalar>& at, const PerJoint<N, Scalar>& thresholds,
                const LawRates<Scalar>& rates, FaultLaw<N, Scalar>& law) {
  const Vector<N, Scalar> torque = detail::torque_of(law, at);
  const Vector<N, Scalar> momentum = detail::momentum_of(law, at);
  law.seen_of_law += rates.filter * (torque - law.seen_of_law);
  law.seen_of_learnt += rates.filter * (at.psi_hat - law.seen_of_learnt);
  law.momentum += rates.filter * (momentum - law.momentum);
  const Vector<N, Scalar> accelerated = rates.alpha * (momentum - law.momentum);
  detail::take_torque(torque, accelerated, at, thresholds, rates.doubt, law);
}

}  // namespace offnominal
