#pragma once

#include <Eigen/Core>
#include <offnominal/diagnosis/estimator.hpp>
#include <offnominal/diagnosis/joint_bound.hpp>
#include <offnominal/diagnosis/tick_filter.hpp>
#include <offnominal/sample.hpp>
#include <offnominal/status.hpp>
#include <offnominal/vector.hpp>

// A second filter beside the estimator's, in TorqueSpace (docs/theory.md, "Two filters"): the same
// residual behind a pole that is farther from 0,
//   omega' = -alpha omega + alpha p + p'_model + psi_hat,  e = p - omega,  mu' = -alpha mu + mu_bar
// with bounds of its own. What is short and strong shows here first, what is small and lasts in the
// estimator's. It learns nothing, and the estimator does not know of it; psi_hat is the network's
// at the tick's beginning.

namespace offnominal {

template <int N, typename Scalar>
struct FastFilterState {
  Vector<N, Scalar> omega = zeros<N, Scalar>();   // of p, N m s or N s
  Vector<N, Scalar> mu = zeros<N, Scalar>();      // of each |e_i|, N m s or N s
  Vector<N, Scalar> error = zeros<N, Scalar>();   // e, N m s or N s
  Vector<N, Scalar> mu_bar = zeros<N, Scalar>();  // at the last sample, N m or N
};

// What a tick began with, of the estimator's state: that is gone when the tick has been made.
template <int N, typename Scalar>
struct FastFilterBegin {
  Vector<N, Scalar> momentum = zeros<N, Scalar>();      // p, N m s or N s
  Vector<N, Scalar> nominal_rate = zeros<N, Scalar>();  // p' of the model, N m or N
  Vector<N, Scalar> psi_hat = zeros<N, Scalar>();       // N m or N
  Vector<N, Scalar> mu_bar = zeros<N, Scalar>();        // N m or N
};

// kInvalidFilterPole: a pole that is no number above the estimator's; kUnstablePeriod: too far for
// a tick. 0: no such filter.
template <int N, typename Scalar>
[[nodiscard]] Status validate_pole(const FastBound<N, Scalar>& bound,
                                   const EstimatorConfig<Scalar>& estimator) {
  if (bound.alpha == 0) return Status::kOk;
  if (!is_finite(bound.alpha) || bound.alpha <= estimator.alpha) return Status::kInvalidFilterPole;
  const bool is_followed = bound.alpha * estimator.period_s <= static_cast<Scalar>(kMaxPolePerTick);
  return is_followed ? Status::kOk : Status::kUnstablePeriod;
}

// The immutable part. Where runs() is false nothing else of it is to be called. `bound` is the one
// that it was made of, which validate_pole() accepts.
template <int N, typename Scalar>
class FastFilter {
 public:
  using Values = Vector<N, Scalar>;
  using Sample = JointSample<N, Scalar>;
  using Bound = FastBound<N, Scalar>;
  using State = FastFilterState<N, Scalar>;
  using Begin = FastFilterBegin<N, Scalar>;
  using Input = EstimatorInput<N, Scalar, TorqueSpace>;

  FastFilter() = default;
  FastFilter(const Bound& bound, const EstimatorConfig<Scalar>& estimator)
      : tick_(tick_filter(bound.alpha, estimator.period_s)), runs_(bound.alpha > 0) {}

  [[nodiscard]] bool runs() const { return runs_; }

  // Starts at a sample, with the bound at its largest behind the filter, as the estimator's. `tau`:
  // that acts there.
  void reset(const Bound& bound, const Sample& sample, const Values& tau, const Values& momentum,
             State& state) const {
    state.omega = momentum;
    state.error.setZero(momentum.size());
    state.mu_bar = bound_at(bound, sample, tau);
    state.mu = first_threshold<N, Scalar>(bound.joints, bound.alpha);
  }

  // Goes on at a sample behind a gap, as the estimator's resume().
  void resume(const Bound& bound, const Sample& sample, const Values& tau, const Values& momentum,
              State& state) const {
    const Values was = state.error;
    state.mu_bar = bound_at(bound, sample, tau);
    state.omega = momentum - was;
    state.error = momentum - state.omega;
    detail::raise_threshold(was, state.error, momentum_allowance<N, Scalar>(bound.joints),
                            state.mu);
  }

  // mu_bar at a sample whose torque may be another, with what a velocity's own error adds.
  [[nodiscard]] Values bound_at(const Bound& bound, const Sample& sample, const Values& tau) const {
    return evaluate<N, Scalar>(bound.joints, sample.q, sample.dq, tau) +
           bound.alpha * momentum_allowance<N, Scalar>(bound.joints);
  }

  // Over a tick from `begin` to `end`, where the bound is `mu_bar`.
  void step(const Bound& bound, const Begin& begin, const Input& end, const Values& mu_bar,
            State& state) const {
    const Values rate_begin = bound.alpha * begin.momentum + begin.nominal_rate + begin.psi_hat;
    const Values rate_end = bound.alpha * end.measured.momentum + end.nominal_rate + begin.psi_hat;
    state.omega = tick_.keep * state.omega + tick_.begin * rate_begin + tick_.end * rate_end;
    state.mu = tick_.keep * state.mu + tick_.begin * begin.mu_bar + tick_.end * mu_bar;
    state.error = end.measured.momentum - state.omega;
    state.mu_bar = mu_bar;
  }

 private:
  TickFilter<Scalar> tick_{};
  bool runs_ = false;
};

}  // namespace offnominal
