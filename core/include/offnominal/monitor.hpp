#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <offnominal/control/accommodation.hpp>
#include <offnominal/diagnosis/bound.hpp>
#include <offnominal/diagnosis/detector.hpp>
#include <offnominal/diagnosis/estimator.hpp>
#include <offnominal/finite.hpp>
#include <offnominal/model/chain.hpp>
#include <offnominal/model/effect_memory.hpp>
#include <offnominal/model/forward_dynamics.hpp>
#include <offnominal/sample.hpp>
#include <offnominal/status.hpp>
#include <type_traits>

namespace offnominal {

template <int N, typename Scalar>
struct MonitorConfig {
  Chain<N, Scalar> chain;
  EstimatorConfig<Scalar> estimator;
  UncertaintyBound<N, Scalar> bound;
  TorqueSignal torque_signal = TorqueSignal::kSampled;
  // Largest compensating torque per joint, N m or N, >= 0. Zero: report, do not act.
  PerJoint<N, Scalar> max_compensation{};
};

// kOk where every part is usable, otherwise the first fault.
template <int L, int N, typename Scalar>
[[nodiscard]] Status validate(const MonitorConfig<N, Scalar>& config) {
  if (const Status status = validate(config.chain); status != Status::kOk) return status;
  if (const Status status = validate<L>(config.estimator); status != Status::kOk) return status;
  const std::size_t joints = config.chain.joints.size();
  if (const Status status = validate(config.bound, joints); status != Status::kOk) return status;
  if (config.max_compensation.size() != joints) return Status::kWrongJointCount;
  for (const Scalar limit : config.max_compensation) {
    if (is_nan(limit) || limit < 0) return Status::kInvalidLimit;
  }
  return Status::kOk;
}

// Everything that changes from tick to tick; plain data, ready to be logged or copied.
template <int N, int L, typename Scalar, typename Memory = WithoutMemory>
struct MonitorState {
  bool initialised = false;
  std::uint64_t tick = 0;  // since reset()
  JointSample<N, Scalar> sample;
  Matrix<N, N, Scalar> inertia_factor = no_values<Matrix<N, N, Scalar>>();  // of M(sample.q), lower
  EstimatorState<N, L, Scalar> estimator;
  DetectorState<Scalar> detector;
  [[no_unique_address]] typename Memory::template Of<N, Scalar>::State memory{};
};

// What a controller reads after a tick.
template <int N, typename Scalar>
struct MonitorOutput {
  double time_s = 0;                               // since reset()
  Vector<N, Scalar> error = zeros<N, Scalar>();    // e = dq - omega, rad/s or m/s
  Scalar error_norm{};                             // |e|
  Scalar threshold{};                              // mu, rad/s or m/s
  Vector<N, Scalar> psi_hat = zeros<N, Scalar>();  // fault estimate, rad/s^2 or m/s^2
  DetectorState<Scalar> detector;
  CompensatingTorque<N, Scalar> compensation;
};

// The whole on-board diagnosis of an N-joint chain with at most L hidden units. The object is the
// immutable part; all that changes is in MonitorState, so that one monitor serves many states.
// Memory: WithMemory where the model may have effects with one (effect_memory.hpp).
template <int N, int L, typename Scalar, typename Memory = WithoutMemory>
class Monitor {
 public:
  using Config = MonitorConfig<N, Scalar>;
  using State = MonitorState<N, L, Scalar, Memory>;
  using Sample = JointSample<N, Scalar>;
  using Output = MonitorOutput<N, Scalar>;
  // Whether its state has a `memory.remembered`: torque that the drive has to be told beside the
  // model's.
  static constexpr bool kRemembers = std::is_same_v<Memory, WithMemory>;

  // Takes the configuration that validate() accepts; otherwise its status, and `monitor` is
  // unchanged.
  [[nodiscard]] static Status create(const Config& config, Monitor& monitor) {
    Status status = validate<L>(config);
    if (status != Status::kOk) return status;
    status = EffectMemoryOf::validate(config.chain, config.estimator.period_s);
    if (status != Status::kOk) return status;
    monitor.config_ = config;
    monitor.model_ = make_model(config.chain);
    monitor.memory_.prepare(config.chain, monitor.model_, config.estimator.period_s);
    size_for(config.max_compensation.size(), monitor.max_compensation_);
    for (std::size_t i = 0; i < config.max_compensation.size(); ++i) {
      monitor.max_compensation_[static_cast<Eigen::Index>(i)] = config.max_compensation[i];
    }
    monitor.ready_ = true;
    return Status::kOk;
  }

  // Starts a run at a sample, time 0. Any refusal leaves `state` unchanged.
  [[nodiscard]] Status reset(const Sample& sample, State& state) const {
    if (!ready_) return Status::kNotInitialised;
    ForwardDynamics<N, Scalar> nominal;
    EstimatorInput<N, Scalar> input;
    const Now now = memory_.begin(sample);
    Status status = look(sample, now, 0.0, nominal, input);
    if (status != Status::kOk) return status;
    status = offnominal::reset(config_.estimator, input, state.estimator);
    if (status != Status::kOk) return status;
    state.estimator.mu = velocity_allowance();
    memory_.keep_begin(sample, now, state.memory);
    state.sample = sample;
    state.inertia_factor = nominal.factor;
    state.detector = {};
    state.tick = 0;
    state.initialised = true;
    return Status::kOk;
  }

  // Goes on at a sample before which `missed` ticks had none. What the joints did meanwhile nobody
  // knows, and integrated as one tick it would look like a fault: the error and what was learnt are
  // kept as they were, the threshold grows by what the velocity's error may add, and time goes on.
  // Any refusal leaves `state` unchanged.
  [[nodiscard]] Status resume(const Sample& sample, std::uint32_t missed, State& state) const {
    if (!ready_ || !state.initialised) return Status::kNotInitialised;
    const std::uint64_t tick = state.tick + missed + 1;
    ForwardDynamics<N, Scalar> nominal;
    EstimatorInput<N, Scalar> input;
    const Now now = memory_.next(sample, missed, state.memory);
    Status status = look(sample, now, time_at(tick), nominal, input);
    if (status != Status::kOk) return status;
    status = offnominal::resume(input, velocity_allowance(), state.estimator);
    if (status != Status::kOk) return status;
    memory_.keep(sample, missed, now, state.memory);
    state.tick = tick;
    state.sample = sample;
    state.inertia_factor = nominal.factor;
    return Status::kOk;
  }

  // One control tick: the sample at its end. Any refusal leaves `state` and `output` unchanged; the
  // next good sample is then taken as if it followed the last good one by one tick, unless resume()
  // is told of the gap.
  [[nodiscard]] Status step(const Sample& sample, State& state, Output& output) const {
    if (!ready_ || !state.initialised) return Status::kNotInitialised;
    const double end_s = time_at(state.tick + 1);
    ForwardDynamics<N, Scalar> nominal;
    EstimatorInput<N, Scalar> input;
    const Now now = memory_.next(sample, 0, state.memory);
    Status status = look(sample, now, end_s, nominal, input);
    if (status != Status::kOk) return status;
    status = offnominal::step(config_.estimator, begin_of_tick(now.acting(sample.tau), state),
                              input, state.estimator);
    if (status != Status::kOk) return status;

    memory_.keep(sample, 0, now, state.memory);
    ++state.tick;
    state.sample = sample;
    state.inertia_factor = nominal.factor;
    output.time_s = end_s;
    output.error = state.estimator.error;
    output.error_norm = detail::length(state.estimator.error);
    output.threshold = state.estimator.mu;
    output.psi_hat = state.estimator.psi_hat;
    update(state.detector, output.error_norm, output.threshold, state.tick, end_s);
    output.detector = state.detector;
    output.compensation = compensating_torque<N, Scalar>(nominal.inertia, output.psi_hat,
                                                         max_compensation_, nominal.told_per_load);
    return Status::kOk;
  }

  [[nodiscard]] const Config& config() const { return config_; }
  [[nodiscard]] const RigidBodyModel<N, Scalar>& model() const { return model_; }

 private:
  using EffectMemoryOf = typename Memory::template Of<N, Scalar>;
  using Now = typename EffectMemoryOf::Now;

  // What the model and the bound say at a sample; refuses one that they cannot judge. Not inlined:
  // on a controller its callers share its code, and the estimator its stack.
  [[nodiscard, gnu::noinline]] Status look(const Sample& sample, const Now& now, double time_s,
                                           ForwardDynamics<N, Scalar>& nominal,
                                           EstimatorInput<N, Scalar>& input) const {
    Status status = validate<N>(sample, config_.chain.joints);
    if (status != Status::kOk) return status;
    const Vector<N, Scalar>& tau = now.acting(sample.tau);
    status =
        forward_dynamics<N, Scalar>(model_, sample.q, sample.dq, now.driving(tau), time_s, nominal);
    if (status != Status::kOk) return status;
    input.z = network_input<N, Scalar>(sample.q, sample.dq, tau);
    input.nominal_ddq = nominal.ddq;
    input.mu_bar = bound_at(sample.q, sample.dq, tau);
    return Status::kOk;
  }

  [[nodiscard]] double time_at(std::uint64_t tick) const {
    return static_cast<double>(tick) * static_cast<double>(config_.estimator.period_s);
  }

  // The velocity's own error e_v enters e directly, through omega(0) and through the filter's
  // input: together at most 2 |e_v|. With mu starting there and alpha times it in the filter's
  // input, mu stays exactly that much above the filtered bound.
  [[nodiscard]] Scalar velocity_allowance() const { return 2 * config_.bound.velocity_error; }
  [[nodiscard]] Scalar bound_at(const Vector<N, Scalar>& q, const Vector<N, Scalar>& dq,
                                const Vector<N, Scalar>& tau) const {
    return evaluate(config_.bound, q, dq, tau) + config_.estimator.alpha * velocity_allowance();
  }

  // A held torque jumps at the sample: f and the bound there are those of the new torque.
  [[nodiscard]] TickBegin<N, Scalar> begin_of_tick(const Vector<N, Scalar>& tau,
                                                   const State& state) const {
    TickBegin<N, Scalar> begin{state.estimator.nominal_ddq, state.estimator.mu_bar};
    if (config_.torque_signal == TorqueSignal::kSampled) return begin;
    Vector<N, Scalar> jump = load_jump(tau, state);
    solve_in_place<N, Scalar>(state.inertia_factor, jump);
    begin.nominal_ddq += jump;
    const bool bound_follows_torque =
        config_.bound.kind == BoundKind::kTable && config_.bound.variable == BoundVariable::kTorque;
    if (bound_follows_torque) begin.mu_bar = bound_at(state.sample.q, state.sample.dq, tau);
    return begin;
  }

  // What the torque's jump at the last sample changes of the load there.
  [[nodiscard]] Vector<N, Scalar> load_jump(const Vector<N, Scalar>& tau,
                                            const State& state) const {
    const Sample& at = state.sample;
    const Vector<N, Scalar>& before = state.memory.acting(at.tau);
    if (!model_.has_torque_path) return tau - before;
    const JointEffects<N, Scalar> effects = joint_effects(model_, at.q, at.dq, time_at(state.tick));
    return load_torque<N, Scalar>(model_, effects, state.memory.driving(tau)) -
           load_torque<N, Scalar>(model_, effects, state.memory.driving(before));
  }

  Config config_{};
  RigidBodyModel<N, Scalar> model_{};
  [[no_unique_address]] EffectMemoryOf memory_{};
  Vector<N, Scalar> max_compensation_ = zeros<N, Scalar>();
  bool ready_ = false;
};

}  // namespace offnominal
