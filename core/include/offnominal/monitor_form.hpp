#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <offnominal/control/accommodation.hpp>
#include <offnominal/diagnosis/bound.hpp>
#include <offnominal/diagnosis/detector.hpp>
#include <offnominal/diagnosis/estimator_state.hpp>
#include <offnominal/diagnosis/fast_filter.hpp>
#include <offnominal/diagnosis/joint_bound.hpp>
#include <offnominal/diagnosis/position_step.hpp>
#include <offnominal/diagnosis/space.hpp>
#include <offnominal/model/cholesky.hpp>
#include <offnominal/model/forward_dynamics.hpp>
#include <offnominal/model/momentum.hpp>
#include <offnominal/status.hpp>

// What a monitor does differently in each space (diagnosis/space.hpp). One specialisation each:
//   Bound, Dynamics           what a configuration says, what the model says of a sample
//   Kept                      of the last sample, and of a second filter, in MonitorState
//   Fast                      that second filter, where it may have one
//   JointOutput, Detector     in MonitorOutput, and in both
//   look(), fill()            model and input of the estimator at a sample
//   start()                   of the detector at the first one
//   allowance(), bound_at()   threshold of a measured velocity's own error, mu_bar
//   first_threshold()         with which a run begins
//   jump()                    of the nominal rate, by a jump of the load at the last sample
//   judge()                   error and threshold of a tick, against each other; and a joint whose
//                             position is where no motion brings it (position_step.hpp)
//   compensate()              torque that takes psi_hat away

namespace offnominal {

template <typename Space, int N, typename Scalar>
struct MonitorForm;

template <int N, typename Scalar>
struct MonitorForm<AccelerationSpace, N, Scalar> {
  using Bound = UncertaintyBound<N, Scalar>;
  using Dynamics = ForwardDynamics<N, Scalar>;
  using Detector = DetectorState<Scalar>;
  using Input = EstimatorInput<N, Scalar, AccelerationSpace>;
  struct Kept {
    Matrix<N, N, Scalar> inertia_factor = no_values<Matrix<N, N, Scalar>>();  // of M(q), lower
  };
  struct JointOutput {};
  struct Fast {};  // none

  [[nodiscard]] static EIGEN_ALWAYS_INLINE Status look(const RigidBodyModel<N, Scalar>& model,
                                                       const JointTransforms<N, Scalar>& at,
                                                       const Vector<N, Scalar>& q,
                                                       const Vector<N, Scalar>& dq,
                                                       const Vector<N, Scalar>& driving,
                                                       double time_s, Dynamics& nominal) {
    return forward_dynamics<N, Scalar>(model, at, q, dq, driving, time_s, nominal);
  }
  static EIGEN_ALWAYS_INLINE void fill(const Dynamics& nominal, Input& input) {
    input.nominal_rate = nominal.ddq;
  }
  static void start(std::size_t /*joints*/, Detector& detector) { detector = {}; }
  static EIGEN_ALWAYS_INLINE void keep(const Dynamics& nominal, Kept& kept) {
    kept.inertia_factor = nominal.factor;
  }

  // The velocity's own error e_v enters e directly, through omega(0) and through the filter's
  // input: together at most 2 |e_v|.
  [[nodiscard]] static Scalar allowance(const Bound& bound) { return 2 * bound.velocity_error; }
  [[nodiscard]] static Scalar first_threshold(const Bound& bound, Scalar /*alpha*/) {
    return allowance(bound);
  }
  [[nodiscard]] static Scalar bound_at(const Bound& bound, const Vector<N, Scalar>& q,
                                       const Vector<N, Scalar>& dq, const Vector<N, Scalar>& tau) {
    return evaluate(bound, q, dq, tau);
  }
  [[nodiscard]] static bool follows_torque(const Bound& bound) {
    return bound.kind == BoundKind::kTable && bound.variable == BoundVariable::kTorque;
  }
  [[nodiscard]] static Vector<N, Scalar> jump(const Kept& kept, Vector<N, Scalar> load) {
    solve_in_place<N, Scalar>(kept.inertia_factor, load);
    return load;
  }

  template <typename State, typename Output>
  static EIGEN_ALWAYS_INLINE void judge(Scalar /*alpha*/, const Bound& /*bound*/,
                                        const Fast& /*fast*/, Eigen::Index jumped, State& state,
                                        Output& output) {
    output.error = state.estimator.error;
    output.error_norm = detail::length(state.estimator.error);
    output.threshold = state.estimator.mu;
    const bool beyond = output.error_norm > output.threshold || jumped != kNoJoint;
    update(state.detector, beyond, state.tick, output.time_s);
  }
  template <typename Output>
  static EIGEN_ALWAYS_INLINE void compensate(const Dynamics& nominal,
                                             const Vector<N, Scalar>& limit, Output& output) {
    output.compensation = compensating_torque<N, Scalar>(nominal.inertia, output.psi_hat, limit,
                                                         nominal.told_per_load);
  }
};

template <int N, typename Scalar>
struct MonitorForm<TorqueSpace, N, Scalar> {
  using Bound = TorqueBound<N, Scalar>;
  using Dynamics = MomentumDynamics<N, Scalar>;
  using Detector = JointDetectors<N, Scalar>;
  using Input = EstimatorInput<N, Scalar, TorqueSpace>;
  using Fast = FastFilter<N, Scalar>;
  struct Kept {
    FastFilterState<N, Scalar> fast;
  };
  struct JointOutput {
    Vector<N, Scalar> thresholds = zeros<N, Scalar>();  // alpha mu_i of |error_i|, N m or N
    // The same of the fast filter, with its own alpha; 0, or no joints, where there is none.
    Vector<N, Scalar> fast_error = zeros<N, Scalar>();
    Vector<N, Scalar> fast_thresholds = zeros<N, Scalar>();
    std::uint8_t worst_joint = 0;  // whose error_norm and threshold are said, from 0
    // What a drive has to be told for 1 N m more behind its gear, MomentumDynamics::told_per_load.
    Vector<N, Scalar> told_per_load = zeros<N, Scalar>();
  };

  [[nodiscard]] static EIGEN_ALWAYS_INLINE Status look(const RigidBodyModel<N, Scalar>& model,
                                                       const JointTransforms<N, Scalar>& at,
                                                       const Vector<N, Scalar>& q,
                                                       const Vector<N, Scalar>& dq,
                                                       const Vector<N, Scalar>& driving,
                                                       double time_s, Dynamics& nominal) {
    nominal = momentum_dynamics<N, Scalar>(model, at, q, dq, driving, time_s);
    return Status::kOk;
  }
  static EIGEN_ALWAYS_INLINE void fill(const Dynamics& nominal, Input& input) {
    input.nominal_rate = nominal.rate;
    input.measured.momentum = nominal.momentum;
  }
  static void start(std::size_t joints, Detector& detector) {
    detector = {};
    size_for(joints, detector.joints);
  }
  static void keep(const Dynamics& /*nominal*/, Kept& /*kept*/) {}

  // As of the velocity's error, joint by joint.
  [[nodiscard]] static Vector<N, Scalar> allowance(const Bound& bound) {
    return momentum_allowance<N, Scalar>(bound.joints);
  }
  [[nodiscard]] static Vector<N, Scalar> first_threshold(const Bound& bound, Scalar alpha) {
    return offnominal::first_threshold<N, Scalar>(bound.joints, alpha);
  }
  [[nodiscard]] static Vector<N, Scalar> bound_at(const Bound& bound, const Vector<N, Scalar>& q,
                                                  const Vector<N, Scalar>& dq,
                                                  const Vector<N, Scalar>& tau) {
    return evaluate<N, Scalar>(bound.joints, q, dq, tau);
  }
  [[nodiscard]] static bool follows_torque(const Bound& bound) {
    return offnominal::follows_torque(bound.joints);
  }
  [[nodiscard]] static const Vector<N, Scalar>& jump(const Kept& /*kept*/,
                                                     const Vector<N, Scalar>& load) {
    return load;
  }

  // In N m: alpha e and alpha mu, what a lasting torque and a lasting bound tend to.
  template <typename State, typename Output>
  static EIGEN_ALWAYS_INLINE void judge(Scalar alpha, const Bound& bound, const Fast& fast,
                                        Eigen::Index jumped, State& state, Output& output) {
    output.error = alpha * state.estimator.error;
    output.thresholds = alpha * state.estimator.mu;
    JointErrors<N, Scalar> errors =
        errors_of<N, Scalar>(output.error, output.thresholds, bound.joints);
    if (fast.runs()) {
      output.fast_error = bound.fast.alpha * state.fast.error;
      output.fast_thresholds = bound.fast.alpha * state.fast.mu;
      add(errors_of<N, Scalar>(output.fast_error, output.fast_thresholds, bound.fast.joints),
          errors);
    }
    const Eigen::Index worst = update(state.detector, errors, jumped, state.tick, output.time_s);
    output.worst_joint = static_cast<std::uint8_t>(worst);
    output.error_norm = errors.size[worst];
    output.threshold = errors.threshold[worst];
  }
  template <typename Output>
  static EIGEN_ALWAYS_INLINE void compensate(const Dynamics& nominal,
                                             const Vector<N, Scalar>& limit, Output& output) {
    output.told_per_load = nominal.told_per_load;
    output.compensation = compensating_torque_of_load<N, Scalar>(
        acted_on<N, Scalar>(output.psi_hat, output.detector), limit, nominal.told_per_load);
  }
};

}  // namespace offnominal
