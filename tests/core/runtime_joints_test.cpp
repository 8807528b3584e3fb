// The same chain with its number of joints known to the compiler and known at run time only: every
// bit of what the core makes of it is the same.

#include <gtest/gtest.h>

#include <bit>
#include <offnominal/control/computed_torque.hpp>
#include <offnominal/control/reference_ramp.hpp>
#include <offnominal/monitor.hpp>

#include "core/model/random_chain.hpp"
#include "core/print_status.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

constexpr int kUnits = 11;

template <typename Values, typename Others>
void expect_same_bits(const Values& one, const Others& other, const char* what) {
  ASSERT_EQ(one.rows(), other.rows()) << what;
  ASSERT_EQ(one.cols(), other.cols()) << what;
  for (Eigen::Index column = 0; column < one.cols(); ++column) {
    for (Eigen::Index row = 0; row < one.rows(); ++row) {
      using Scalar = typename Values::Scalar;
      using Bits = std::conditional_t<sizeof(Scalar) == 4, std::uint32_t, std::uint64_t>;
      ASSERT_EQ(std::bit_cast<Bits>(one(row, column)), std::bit_cast<Bits>(other(row, column)))
          << what << " at " << row << ", " << column << ": " << one(row, column) << " and "
          << other(row, column);
    }
  }
}

template <typename From, typename Into>
void take_all(const From& from, Into& into) {
  into.assign(from.size(), typename std::decay_t<decltype(from[0])>{});
  for (std::size_t i = 0; i < from.size(); ++i) into[i] = from[i];
}

template <int N, typename Scalar>
void take_bound(const UncertaintyBound<N, Scalar>& from,
                UncertaintyBound<kRuntimeJoints, Scalar>& bound) {
  bound.kind = from.kind;
  bound.velocity_error = from.velocity_error;
  bound.offset = from.offset;
  bound.scale = from.scale;
  take_all(from.matrix, bound.matrix);
  bound.variable = from.variable;
  bound.joint = from.joint;
  bound.points = from.points;
  bound.at = from.at;
  bound.value = from.value;
}
template <int N, typename Scalar>
void take_bound(const TorqueBound<N, Scalar>& from, TorqueBound<kRuntimeJoints, Scalar>& bound) {
  take_all(from.joints, bound.joints);
  bound.fast.alpha = from.fast.alpha;
  take_all(from.fast.joints, bound.fast.joints);
}

template <int N, typename Scalar, typename Space>
MonitorConfig<kRuntimeJoints, Scalar, Space> at_run_time(
    const MonitorConfig<N, Scalar, Space>& from) {
  MonitorConfig<kRuntimeJoints, Scalar, Space> config;
  take_all(from.chain.joints, config.chain.joints);
  config.chain.gravity_m_s2 = from.chain.gravity_m_s2;
  for (const Effect<Scalar>& effect : from.chain.effects.view()) {
    EXPECT_TRUE(config.chain.effects.add(effect));
  }
  config.estimator = from.estimator;
  take_bound(from.bound, config.bound);
  config.torque_signal = from.torque_signal;
  take_all(from.max_compensation, config.max_compensation);
  return config;
}

// Every way in which an effect acts.
template <int N, typename Scalar, typename Space>
MonitorConfig<N, Scalar, Space> any_arm(TorqueSignal signal, std::mt19937_64& generator) {
  MonitorConfig<N, Scalar, Space> config;
  config.chain = random_chain<N, Scalar>(generator);
  const auto add = [&](EffectKind kind, int joint,
                       std::array<Scalar, kMaxEffectParameters> parameters) {
    EXPECT_TRUE(config.chain.effects.add({kind, static_cast<std::uint8_t>(joint), parameters}));
  };
  for (int i = 0; i < N; ++i) add(EffectKind::kViscousFriction, i, {Scalar(0.5)});
  add(EffectKind::kRotorInertia, 0, {Scalar(0.2)});
  add(EffectKind::kTipPayload, N - 1, {Scalar(0.3), Scalar(0.1), Scalar(0), Scalar(0.2)});
  add(EffectKind::kLoadDependentFriction, N - 1, {Scalar(0.1), Scalar(0.05)});
  add(EffectKind::kTorqueScale, 0, {Scalar(0.1)});
  add(EffectKind::kHysteresis, N / 2, {Scalar(0.4), Scalar(0.05)});
  add(EffectKind::kTimeDelay, N - 1, {Scalar(0.0025)});
  if (N > 1)
    add(EffectKind::kJointCoupling, 0, {Scalar(0.1), Scalar(0.2), Scalar(N), Scalar(0.01)});
  config.estimator.hidden_units = kUnits - 1;
  config.estimator.learning_rate = 40;
  config.estimator.weight_radius = 3;
  config.torque_signal = signal;
  config.max_compensation.fill(Scalar(2));
  return config;
}

template <int N, typename Scalar>
MonitorConfig<N, Scalar> any_config(BoundKind bound, TorqueSignal signal,
                                    std::mt19937_64& generator) {
  auto config = any_arm<N, Scalar, AccelerationSpace>(signal, generator);
  config.bound.kind = bound;
  config.bound.offset = Scalar(0.01);
  config.bound.velocity_error = Scalar(0.001);
  for (Scalar& value : config.bound.matrix) value = static_cast<Scalar>(uniform(generator, 0, 0.1));
  config.bound.variable = BoundVariable::kTorque;
  config.bound.joint = static_cast<std::uint8_t>(N - 1);
  config.bound.points = 2;
  config.bound.at[1] = 5;
  config.bound.value = {Scalar(0.05), Scalar(0.1)};
  return config;
}

template <int N, typename Scalar>
MonitorConfig<N, Scalar, TorqueSpace> any_torque_config(TorqueSignal signal,
                                                        std::mt19937_64& generator) {
  auto config = any_arm<N, Scalar, TorqueSpace>(signal, generator);
  for (JointBound<Scalar>& joint : config.bound.joints) {
    joint.points = 2;
    joint.at[1] = Scalar(0.3);
    joint.value = {Scalar(0.05), static_cast<Scalar>(uniform(generator, 0.1, 0.5))};
    joint.momentum_error = Scalar(0.001);
    joint.act_ratio = Scalar(1.5);
  }
  config.bound.fast.alpha = 60;
  for (JointBound<Scalar>& joint : config.bound.fast.joints) {
    joint.variable = BoundVariable::kTorque;
    joint.points = 2;
    joint.at[1] = Scalar(0.3);
    joint.value = {Scalar(0.5), static_cast<Scalar>(uniform(generator, 1, 5))};
  }
  return config;
}

// Both monitors over the same motion.
template <int N, typename Scalar, typename Space>
class Pair {
 public:
  using Fixed = Monitor<N, kUnits, Scalar, WithMemory, Space>;
  using AtRunTime = Monitor<kRuntimeJoints, kUnits, Scalar, WithMemory, Space>;

  explicit Pair(const MonitorConfig<N, Scalar, Space>& config) {
    EXPECT_EQ(Fixed::create(config, fixed_), Status::kOk);
    EXPECT_EQ(AtRunTime::create(at_run_time(config), at_run_time_), Status::kOk);
    for (std::size_t i = 0; i < gains_.kp.size(); ++i) {
      gains_.kp[i] = static_cast<Scalar>(10 + i);
      gains_.kd[i] = static_cast<Scalar>(5 + i);
    }
    take_all(gains_.kp, other_gains_.kp);
    take_all(gains_.kd, other_gains_.kd);
  }

  // One sample: of a motion that the model does not explain.
  JointSample<N, Scalar> sample(int tick, std::mt19937_64& generator) {
    JointSample<N, Scalar> sample;
    for (Eigen::Index i = 0; i < N; ++i) {
      const double phase = 0.01 * tick * static_cast<double>(i + 1);
      sample.q[i] = static_cast<Scalar>(0.4 * std::sin(phase));
      sample.dq[i] = static_cast<Scalar>(0.4 * std::cos(phase));
    }
    const Reference<N, Scalar> reference;
    const Reference<kRuntimeJoints, Scalar> other{zeros<kRuntimeJoints, Scalar>(N),
                                                  zeros<kRuntimeJoints, Scalar>(N),
                                                  zeros<kRuntimeJoints, Scalar>(N)};
    const Vector<kRuntimeJoints, Scalar> q = sample.q;
    const Vector<kRuntimeJoints, Scalar> dq = sample.dq;
    sample.tau = computed_torque(fixed_.model(), gains_, reference, sample.q, sample.dq, 0.0);
    expect_same_bits(sample.tau,
                     computed_torque(at_run_time_.model(), other_gains_, other, q, dq, 0.0),
                     "computed torque");
    sample.tau += random_vector<N, Scalar>(generator, 1.0);
    return sample;
  }

  void run(std::mt19937_64& generator) {
    for (int tick = 0; tick < 60; ++tick) {
      const JointSample<N, Scalar> now = sample(tick, generator);
      const JointSample<kRuntimeJoints, Scalar> same{now.q, now.dq, now.tau};
      if (tick == 0) {
        ASSERT_EQ(fixed_.reset(now, state_), Status::kOk);
        ASSERT_EQ(at_run_time_.reset(same, other_state_), Status::kOk);
      } else if (tick == 30) {
        ASSERT_EQ(fixed_.resume(now, 3, state_), Status::kOk);
        ASSERT_EQ(at_run_time_.resume(same, 3, other_state_), Status::kOk);
      } else {
        ASSERT_EQ(fixed_.step(now, state_, output_), Status::kOk);
        ASSERT_EQ(at_run_time_.step(same, other_state_, other_output_), Status::kOk);
        compare_outputs();
      }
      compare_states();
      if (testing::Test::HasFatalFailure()) return;
    }
    EXPECT_TRUE(output_.detector.latched);
    EXPECT_GT(output_.psi_hat.norm(), 0);
  }

 private:
  void compare_outputs() {
    using One = Eigen::Matrix<Scalar, 1, 1>;
    expect_same_bits(output_.error, other_output_.error, "e");
    expect_same_bits(One(output_.error_norm), One(other_output_.error_norm), "|e|");
    expect_same_bits(One(output_.threshold), One(other_output_.threshold), "mu");
    expect_same_bits(output_.psi_hat, other_output_.psi_hat, "psi_hat");
    expect_same_bits(output_.compensation.torque, other_output_.compensation.torque,
                     "compensation");
    EXPECT_EQ(output_.detector.level, other_output_.detector.level);
    if constexpr (std::is_same_v<Space, TorqueSpace>) {
      expect_same_bits(output_.thresholds, other_output_.thresholds, "thresholds");
      expect_same_bits(output_.fast_error, other_output_.fast_error, "fast e");
      expect_same_bits(output_.fast_thresholds, other_output_.fast_thresholds, "fast thresholds");
      EXPECT_EQ(output_.detector.acts, other_output_.detector.acts);
      ASSERT_EQ(other_output_.detector.joints.size(), output_.detector.joints.size());
      EXPECT_EQ(output_.detector.first_joint, other_output_.detector.first_joint);
    }
  }
  void compare_states() {
    const auto& one = state_.estimator;
    const auto& other = other_state_.estimator;
    expect_same_bits(one.omega, other.omega, "omega");
    expect_same_bits(one.weights.w1, other.weights.w1, "W1");
    expect_same_bits(one.weights.w2_transposed, other.weights.w2_transposed, "W2");
    expect_same_bits(one.nominal_rate, other.nominal_rate, "f");
    if constexpr (std::is_same_v<Space, TorqueSpace>) {
      expect_same_bits(one.measured.momentum, other.measured.momentum, "p");
    } else {
      expect_same_bits(state_.inertia_factor, other_state_.inertia_factor, "factor of M");
    }
    expect_same_bits(state_.memory.tau, other_state_.memory.tau, "torque that acts");
    expect_same_bits(state_.memory.remembered, other_state_.memory.remembered, "remembered");
  }

  Fixed fixed_;
  AtRunTime at_run_time_;
  ComputedTorqueGains<N, Scalar> gains_;
  ComputedTorqueGains<kRuntimeJoints, Scalar> other_gains_;
  typename Fixed::State state_;
  typename AtRunTime::State other_state_;
  typename Fixed::Output output_;
  typename AtRunTime::Output other_output_;
};

template <int N, typename Scalar>
void expect_the_same(std::mt19937_64& generator) {
  SCOPED_TRACE(std::to_string(N) + " joints, " + (sizeof(Scalar) == 4 ? "float" : "double"));
  for (const BoundKind bound : {BoundKind::kConstant, BoundKind::kScaledNorm, BoundKind::kTable}) {
    for (const TorqueSignal signal : {TorqueSignal::kSampled, TorqueSignal::kHeld}) {
      Pair(any_config<N, Scalar>(bound, signal, generator)).run(generator);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
  for (const TorqueSignal signal : {TorqueSignal::kSampled, TorqueSignal::kHeld}) {
    Pair(any_torque_config<N, Scalar>(signal, generator)).run(generator);
    if (testing::Test::HasFatalFailure()) return;
  }
}

template <typename Scalar, int... N>
void expect_the_same_of(std::mt19937_64& generator, std::integer_sequence<int, N...> /*joints*/) {
  (expect_the_same<N, Scalar>(generator), ...);
}

TEST(RuntimeJoints, ComputeInDoublesToTheBitWhatTheCompilerMakesOfTheirNumber) {
  std::mt19937_64 generator = seeded_generator();
  expect_the_same_of<double>(generator, std::integer_sequence<int, 1, 2, 3, 4, 5, 6, 7, 8>{});
}
TEST(RuntimeJoints, ComputeInFloatsToTheBitWhatTheCompilerMakesOfTheirNumber) {
  std::mt19937_64 generator = seeded_generator();
  expect_the_same_of<float>(generator, std::integer_sequence<int, 2, 7>{});
}

}  // namespace
}  // namespace offnominal::test
