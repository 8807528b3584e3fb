#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <offnominal/diagnosis/known_friction.hpp>
#include <offnominal/model/smooth_sign.hpp>
#include <offnominal/model/tip_body.hpp>
#include <offnominal/monitor.hpp>

// The unmodelled torque u of each joint, p' = (model) + u, averaged over a block of ticks. From the
// estimator's e' = -alpha e + u - psi_hat follows
//   mean u = (e_end - e_begin) / D + mean(alpha e) + mean(psi_hat)
// over D seconds: what the residual and the network hold, with the filter taken away. Hence a fault
// shows in the block that it begins in, and no regressor has to be filtered from an instant that
// nobody knows. A body on the last link, with the momentum form p_k, pull_k per parameter, makes
//   mean u = theta_k (mean pull_k - (p_k,end - p_k,begin) / D)
// of it: no acceleration is asked for. Means are of straight lines between the ticks.

namespace offnominal {

// Regressors of a joint's own hypotheses: what u is per unit of each.
enum OwnRegressor : std::uint8_t {
  kSignRegressor = 0,      // -sign(dq): dry friction, N m or N
  kVelocityRegressor = 1,  // -dq: viscous friction
  kTorqueRegressor = 2,    // -tau: share of the torque that is lost
  kOneRegressor = 3,       // 1: a constant torque on the joint
};
inline constexpr int kOwnRegressors = 4;

// Columns: joints.
template <int N, typename Scalar>
using OwnValues = Matrix<kOwnRegressors, N, Scalar>;
template <int N, typename Scalar>
using TipValues = typename TipBodyForm<N, Scalar>::Values;

// Means over one block.
template <int N, typename Scalar>
struct IsolationBlock {
  Vector<N, Scalar> torque = zeros<N, Scalar>();  // u, N m or N
  OwnValues<N, Scalar> own = no_values<OwnValues<N, Scalar>>();
  TipValues<N, Scalar> tip = no_values<TipValues<N, Scalar>>();
};

// What holds at one tick.
template <int N, typename Scalar>
struct IsolationInstant {
  Vector<N, Scalar> residual = zeros<N, Scalar>();  // alpha e, N m or N
  Vector<N, Scalar> psi_hat = zeros<N, Scalar>();
  OwnValues<N, Scalar> own = no_values<OwnValues<N, Scalar>>();
  TipBodyForm<N, Scalar> tip{};
};

// Of a sample that the monitor has just accepted.
template <int N, typename Scalar>
[[nodiscard]] IsolationInstant<N, Scalar> isolation_instant(
    const RigidBodyModel<N, Scalar>& model, const JointSample<N, Scalar>& sample,
    const JointTransforms<N, Scalar>& transforms,
    const MonitorOutput<N, Scalar, TorqueSpace>& output,
    const PerJoint<N, KnownFriction<Scalar>>& friction) {
  // The tip's form is made where it stays.
  IsolationInstant<N, Scalar> at{output.error, output.psi_hat, OwnValues<N, Scalar>(),
                                 tip_body_form<N, Scalar>(model, transforms, sample.dq)};
  at.own.resize(kOwnRegressors, sample.dq.size());
  for (Eigen::Index i = 0; i < sample.dq.size(); ++i) {
    at.own(kSignRegressor, i) =
        -smooth_sign(sample.dq[i], friction[static_cast<std::size_t>(i)].width);
    at.own(kVelocityRegressor, i) = -sample.dq[i];
    at.own(kTorqueRegressor, i) = -sample.tau[i];
    at.own(kOneRegressor, i) = Scalar(1);
  }
  return at;
}

// A block in progress: sums of the trapezoids so far.
template <int N, typename Scalar>
struct IsolationSum {
  IsolationBlock<N, Scalar> sum;
  IsolationInstant<N, Scalar> begin;  // of the block
  IsolationInstant<N, Scalar> last;   // of the last tick
  std::uint16_t ticks = 0;
};

// Starts a block at a tick.
template <int N, typename Scalar>
void begin_block(const IsolationInstant<N, Scalar>& at, IsolationSum<N, Scalar>& block) {
  block.begin = at;
  block.last = at;
  block.ticks = 0;
  block.sum.torque.setZero(at.residual.size());
  block.sum.own.setZero(kOwnRegressors, at.own.cols());
  block.sum.tip.setZero(kTipParameters, at.own.cols());
}

// Takes one tick.
template <int N, typename Scalar>
void add_tick(const IsolationInstant<N, Scalar>& at, IsolationSum<N, Scalar>& block) {
  const Scalar half(0.5);
  const IsolationInstant<N, Scalar>& last = block.last;
  block.sum.torque += half * (at.residual + last.residual + at.psi_hat + last.psi_hat);
  block.sum.own += half * (at.own + last.own);
  block.sum.tip += half * (at.tip.pull + last.tip.pull);
  block.last = at;
  ++block.ticks;
}

// What a block of at least one tick has come to. alpha, 1/s: the monitor's.
template <int N, typename Scalar>
[[nodiscard]] IsolationBlock<N, Scalar> finished(const IsolationSum<N, Scalar>& block, Scalar alpha,
                                                 Scalar period_s) {
  IsolationBlock<N, Scalar> means = block.sum;
  const Scalar per_tick = Scalar(1) / static_cast<Scalar>(block.ticks);
  const Scalar per_second = per_tick / period_s;
  means.torque =
      per_tick * means.torque + (per_second / alpha) * (block.last.residual - block.begin.residual);
  means.own *= per_tick;
  means.tip =
      per_tick * means.tip - per_second * (block.last.tip.momentum - block.begin.tip.momentum);
  return means;
}

}  // namespace offnominal
