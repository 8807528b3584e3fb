#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <offnominal/diagnosis/estimator.hpp>
#include <offnominal/diagnosis/position_step.hpp>
#include <offnominal/finite.hpp>
#include <offnominal/model/chain.hpp>
#include <offnominal/model/effect_memory.hpp>
#include <offnominal/model/joint_transforms.hpp>
#include <offnominal/monitor_form.hpp>
#include <offnominal/sample.hpp>
#include <offnominal/status.hpp>
#include <type_traits>

namespace offnominal {

// Space: TorqueSpace for thresholds joint by joint (diagnosis/space.hpp); the default is the
// paper's.
template <int N, typename Scalar, typename Space = AccelerationSpace>
struct MonitorConfig {
  Chain<N, Scalar> chain;
  EstimatorConfig<Scalar> estimator;
  typename MonitorForm<Space, N, Scalar>::Bound bound;
  TorqueSignal torque_signal = TorqueSignal::kSampled;
  // Largest compensating torque per joint, N m or N, >= 0. Zero: report, do not act.
  PerJoint<N, Scalar> max_compensation{};
};

// kOk where every part is usable, otherwise the first fault.
template <int L, int N, typename Scalar, typename Space>
[[nodiscard]] Status validate(const MonitorConfig<N, Scalar, Space>& config) {
  if (const Status status = validate(config.chain); status != Status::kOk) return status;
  if (const Status status = validate<L>(config.estimator); status != Status::kOk) return status;
  const std::size_t joints = config.chain.joints.size();
  if (const Status status = validate(config.bound, joints); status != Status::kOk) return status;
  if constexpr (std::is_same_v<Space, TorqueSpace>) {
    const Status status = validate_pole<N, Scalar>(config.bound.fast, config.estimator);
    if (status != Status::kOk) return status;
  }
  if (config.max_compensation.size() != joints) return Status::kWrongJointCount;
  for (const Scalar limit : config.max_compensation) {
    if (is_nan(limit) || limit < 0) return Status::kInvalidLimit;
  }
  return Status::kOk;
}

// Everything that changes from tick to tick; plain data, ready to be logged or copied.
template <int N, int L, typename Scalar, typename Memory = WithoutMemory,
          typename Space = AccelerationSpace>
struct MonitorState : MonitorForm<Space, N, Scalar>::Kept {
  bool initialised = false;
  std::uint64_t tick = 0;  // since reset()
  JointSample<N, Scalar> sample;
  EstimatorState<N, L, Scalar, Space> estimator;
  typename MonitorForm<Space, N, Scalar>::Detector detector;
  PerJoint<N, KnownSteps<Scalar>> steps{};
  [[no_unique_address]] typename Memory::template Of<N, Scalar>::State memory{};
};

// What a controller reads after a tick. In TorqueSpace error is the residual alpha (p - omega) in N
// m or N, psi_hat too, error_norm and threshold are those of the joint that is nearest to its
// threshold, or farthest beyond; `thresholds` and detector.joints say it of every joint.
template <int N, typename Scalar, typename Space = AccelerationSpace>
struct MonitorOutput : MonitorForm<Space, N, Scalar>::JointOutput {
  double time_s = 0;                               // since reset()
  Vector<N, Scalar> error = zeros<N, Scalar>();    // e = dq - omega, rad/s or m/s
  Scalar error_norm{};                             // |e|
  Scalar threshold{};                              // mu, rad/s or m/s
  Vector<N, Scalar> psi_hat = zeros<N, Scalar>();  // fault estimate, rad/s^2 or m/s^2
  typename MonitorForm<Space, N, Scalar>::Detector detector;
  CompensatingTorque<N, Scalar> compensation;
};

// The whole on-board diagnosis of an N-joint chain with at most L hidden units. The object is the
// immutable part; all that changes is in MonitorState, so that one monitor serves many states.
// Memory: WithMemory where the model may have effects with one (effect_memory.hpp).
// Space: in which quantity it compares (diagnosis/space.hpp).
template <int N, int L, typename Scalar, typename Memory = WithoutMemory,
          typename Space = AccelerationSpace>
class Monitor {
 public:
  using Config = MonitorConfig<N, Scalar, Space>;
  using State = MonitorState<N, L, Scalar, Memory, Space>;
  using Sample = JointSample<N, Scalar>;
  using Output = MonitorOutput<N, Scalar, Space>;
  using Transforms = JointTransforms<N, Scalar>;
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
    if constexpr (kByJoint) {
      monitor.fast_ = FastFilter<N, Scalar>(config.bound.fast, config.estimator);
    }
    monitor.model_ = make_model(config.chain);
    monitor.memory_.prepare(config.chain, monitor.model_, config.estimator.period_s);
    size_for(config.max_compensation.size(), monitor.max_compensation_);
    for (std::size_t i = 0; i < config.max_compensation.size(); ++i) {
      monitor.max_compensation_[static_cast<Eigen::Index>(i)] = config.max_compensation[i];
    }
    monitor.ready_ = true;
    return Status::kOk;
  }

  // Starts a run at a sample, time 0. Any refusal leaves `state` unchanged. `at`, here and below:
  // joint_transforms() of this model and the sample's positions, where somebody else wants them
  // too; those of others make a wrong answer that nothing tells.
  [[nodiscard]] Status reset(const Sample& sample, State& state) const {
    return reset(sample, transforms_of(sample), state);
  }
  [[nodiscard]] Status reset(const Sample& sample, const Transforms& at, State& state) const {
    if (!ready_) return Status::kNotInitialised;
    Dynamics nominal;
    Input input;
    const Now now = memory_.begin(sample);
    Status status = look(sample, at, now, 0.0, nominal, input);
    if (status != Status::kOk) return status;
    status = offnominal::reset(config_.estimator, input, state.estimator);
    if (status != Status::kOk) return status;
    state.estimator.mu = Form::first_threshold(config_.bound, config_.estimator.alpha);
    if constexpr (kByJoint) {
      if (fast_.runs()) {
        fast_.reset(config_.bound.fast, sample, now.acting(sample.tau), input.measured.momentum,
                    state.fast);
      }
    }
    memory_.keep_begin(sample, now, state.memory);
    state.sample = sample;
    Form::keep(nominal, state);
    Form::start(config_.chain.joints.size(), state.detector);
    size_for(config_.chain.joints.size(), state.steps);
    for (KnownSteps<Scalar>& steps : state.steps) steps = {};
    state.tick = 0;
    state.initialised = true;
    return Status::kOk;
  }

  // Goes on at a sample before which `missed` ticks had none. What the joints did meanwhile nobody
  // knows, and integrated as one tick it would look like a fault: the error and what was learnt are
  // kept as they were, the threshold grows by what the velocity's error may add, and time goes on.
  // Any refusal leaves `state` unchanged.
  [[nodiscard]] Status resume(const Sample& sample, std::uint32_t missed, State& state) const {
    return resume(sample, transforms_of(sample), missed, state);
  }
  [[nodiscard]] Status resume(const Sample& sample, const Transforms& at, std::uint32_t missed,
                              State& state) const {
    if (!ready_ || !state.initialised) return Status::kNotInitialised;
    const std::uint64_t tick = state.tick + missed + 1;
    Dynamics nominal;
    Input input;
    const Now now = memory_.next(sample, missed, state.memory);
    Status status = look(sample, at, now, time_at(tick), nominal, input);
    if (status != Status::kOk) return status;
    status = offnominal::resume(input, velocity_allowance(), state.estimator);
    if (status != Status::kOk) return status;
    if constexpr (kByJoint) {
      if (fast_.runs()) {
        fast_.resume(config_.bound.fast, sample, now.acting(sample.tau), input.measured.momentum,
                     state.fast);
      }
    }
    memory_.keep(sample, missed, now, state.memory);
    state.tick = tick;
    state.sample = sample;
    Form::keep(nominal, state);
    return Status::kOk;
  }

  // One control tick: the sample at its end. Any refusal leaves `state` and `output` unchanged; the
  // next good sample is then taken as if it followed the last good one by one tick, unless resume()
  // is told of the gap: what a joint went in several ticks may then be a fault.
  [[nodiscard]] Status step(const Sample& sample, State& state, Output& output) const {
    return step(sample, transforms_of(sample), state, output);
  }
  [[nodiscard]] Status step(const Sample& sample, const Transforms& at, State& state,
                            Output& output) const {
    if (!ready_ || !state.initialised) return Status::kNotInitialised;
    const double end_s = time_at(state.tick + 1);
    Dynamics nominal;
    Input input;
    const Now now = memory_.next(sample, 0, state.memory);
    Status status = look(sample, at, now, end_s, nominal, input);
    if (status != Status::kOk) return status;
    const Vector<N, Scalar>& tau = now.acting(sample.tau);
    const TickBegin<N, Scalar, Space> begin = begin_of_tick(tau, state);
    [[maybe_unused]] const bool has_fast = runs_fast();
    [[maybe_unused]] FastBegin fast_begin;
    if (has_fast) begin_of_fast(begin, tau, state, fast_begin);
    status = offnominal::step(config_.estimator, begin, input, state.estimator);
    if (status != Status::kOk) return status;
    if constexpr (kByJoint) {
      if (has_fast) {
        const FastBound<N, Scalar>& bound = config_.bound.fast;
        fast_.step(bound, fast_begin, input, fast_.bound_at(bound, sample, tau), state.fast);
      }
    }

    memory_.keep(sample, 0, now, state.memory);
    ++state.tick;
    const Eigen::Index jumped = take_steps<N, Scalar>(
        config_.chain.joints, state.sample.q, sample.q, config_.estimator.period_s, state.steps);
    state.sample = sample;
    Form::keep(nominal, state);
    output.time_s = end_s;
    Form::judge(config_.estimator.alpha, config_.bound, fast_, jumped, state, output);
    output.psi_hat = state.estimator.psi_hat;
    output.detector = state.detector;
    Form::compensate(nominal, max_compensation_, output);
    return Status::kOk;
  }

  // Takes `load` away, N m or N, at the tick that `output` is of, which step() has accepted: where
  // it is known better than by psi_hat (FaultLaw). In TorqueSpace. As of psi_hat, nothing before a
  // joint is beyond the second level, and nothing of one that was only noticed.
  template <typename JointOutput>
  [[nodiscard]] CompensatingTorque<N, Scalar> compensation_of(const Vector<N, Scalar>& load,
                                                              const JointOutput& output) const {
    return compensating_torque_of_load<N, Scalar>(acted_on<N, Scalar>(load, output.detector),
                                                  max_compensation_, output.told_per_load);
  }

  [[nodiscard]] const Config& config() const { return config_; }
  [[nodiscard]] const RigidBodyModel<N, Scalar>& model() const { return model_; }

 private:
  using Form = MonitorForm<Space, N, Scalar>;
  using Dynamics = typename Form::Dynamics;
  using Input = EstimatorInput<N, Scalar, Space>;
  using Threshold = typename Space::template Threshold<N, Scalar>;
  using EffectMemoryOf = typename Memory::template Of<N, Scalar>;
  using Now = typename EffectMemoryOf::Now;
  static constexpr bool kByJoint = std::is_same_v<Space, TorqueSpace>;
  using FastBegin = std::conditional_t<kByJoint, FastFilterBegin<N, Scalar>, typename Form::Fast>;

  // Of a sample that look() refuses anything.
  [[nodiscard]] Transforms transforms_of(const Sample& sample) const {
    Transforms at;
    const bool has_all =
        N != kRuntimeJoints || sample.q.size() == static_cast<Eigen::Index>(model_.bodies.size());
    if (ready_ && has_all) joint_transforms(model_, sample.q, at);
    return at;
  }

  // What the model and the bound say at a sample; refuses one that they cannot judge. Not inlined:
  // on a controller its callers share its code, and the estimator its stack.
  [[nodiscard, gnu::noinline]] Status look(const Sample& sample, const Transforms& at,
                                           const Now& now, double time_s, Dynamics& nominal,
                                           Input& input) const {
    Status status = validate<N>(sample, config_.chain.joints);
    if (status != Status::kOk) return status;
    const Vector<N, Scalar>& tau = now.acting(sample.tau);
    status = Form::look(model_, at, sample.q, sample.dq, now.driving(tau), time_s, nominal);
    if (status != Status::kOk) return status;
    input.z = network_input<N, Scalar>(sample.q, sample.dq, tau);
    Form::fill(nominal, input);
    input.mu_bar = bound_at(sample.q, sample.dq, tau);
    return Status::kOk;
  }

  [[nodiscard]] double time_at(std::uint64_t tick) const {
    return static_cast<double>(tick) * static_cast<double>(config_.estimator.period_s);
  }

  // With mu starting there and alpha times it in the filter's input, mu stays exactly that much
  // above the filtered bound.
  [[nodiscard]] Threshold velocity_allowance() const { return Form::allowance(config_.bound); }
  [[nodiscard]] Threshold bound_at(const Vector<N, Scalar>& q, const Vector<N, Scalar>& dq,
                                   const Vector<N, Scalar>& tau) const {
    return Form::bound_at(config_.bound, q, dq, tau) +
           config_.estimator.alpha * velocity_allowance();
  }

  // A held torque jumps at the sample: f and the bound there are those of the new torque.
  [[nodiscard]] TickBegin<N, Scalar, Space> begin_of_tick(const Vector<N, Scalar>& tau,
                                                          const State& state) const {
    TickBegin<N, Scalar, Space> begin{state.estimator.nominal_rate, state.estimator.mu_bar};
    if (config_.torque_signal == TorqueSignal::kSampled) return begin;
    begin.nominal_rate += Form::jump(state, load_jump(tau, state));
    if (Form::follows_torque(config_.bound)) {
      begin.mu_bar = bound_at(state.sample.q, state.sample.dq, tau);
    }
    return begin;
  }

  [[nodiscard]] bool runs_fast() const {
    if constexpr (kByJoint) return fast_.runs();
    return false;
  }
  // Of a filter that runs beside the estimator's; its bound at a held torque too.
  EIGEN_ALWAYS_INLINE void begin_of_fast([[maybe_unused]] const TickBegin<N, Scalar, Space>& begin,
                                         [[maybe_unused]] const Vector<N, Scalar>& tau,
                                         [[maybe_unused]] const State& state,
                                         [[maybe_unused]] FastBegin& of_fast) const {
    if constexpr (kByJoint) {
      const FastBound<N, Scalar>& bound = config_.bound.fast;
      of_fast = {state.estimator.measured.momentum, begin.nominal_rate, state.estimator.psi_hat,
                 state.fast.mu_bar};
      if (config_.torque_signal == TorqueSignal::kHeld && follows_torque(bound.joints)) {
        of_fast.mu_bar = fast_.bound_at(bound, state.sample, tau);
      }
    }
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
  [[no_unique_address]] typename Form::Fast fast_{};
  Vector<N, Scalar> max_compensation_ = zeros<N, Scalar>();
  bool ready_ = false;
};

}  // namespace offnominal
