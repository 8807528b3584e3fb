#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <offnominal/model/inverse_dynamics.hpp>
#include <offnominal/monitor.hpp>

#include "core/model/random_chain.hpp"
#include "core/print_status.hpp"
#include "support/seed.hpp"

// The monitor joint by joint, in torques.

namespace offnominal::test {
namespace {

constexpr int kSpatial = 5;
constexpr int kSpatialUnits = 8;
template <typename Scalar>
using SpatialWatch = Monitor<kSpatial, kSpatialUnits, Scalar, WithoutMemory, TorqueSpace>;
template <typename Scalar>
using SpatialConfig = typename SpatialWatch<Scalar>::Config;
using Five = Vector<kSpatial, double>;

// A chain in space with friction, rotors, a payload, and effects on the torque's way.
template <typename Scalar>
SpatialConfig<Scalar> spatial_config(std::mt19937_64& generator) {
  SpatialConfig<Scalar> config;
  config.chain = random_chain<kSpatial, Scalar>(generator);
  const auto add = [&](EffectKind kind, int joint,
                       std::array<Scalar, kMaxEffectParameters> parameters) {
    EXPECT_TRUE(config.chain.effects.add({kind, static_cast<std::uint8_t>(joint), parameters}));
  };
  for (int i = 0; i < kSpatial; ++i) {
    add(EffectKind::kViscousFriction, i, {Scalar(0.5)});
    add(EffectKind::kRotorInertia, i, {Scalar(0.1)});
  }
  add(EffectKind::kTipPayload, kSpatial - 1, {Scalar(0.3), Scalar(0.1), Scalar(0), Scalar(0.2)});
  add(EffectKind::kLoadDependentFriction, 1, {Scalar(0.1), Scalar(0.05)});
  add(EffectKind::kTorqueScale, 2, {Scalar(0.1)});
  config.estimator.hidden_units = kSpatialUnits;
  for (JointBound<Scalar>& joint : config.bound.joints) joint.value[0] = Scalar(0.5);
  config.max_compensation.fill(Scalar(100));
  return config;
}

// The arm on given sines; the torque that the model needs for it, less `fault`.
template <typename Scalar>
JointSample<kSpatial, Scalar> on_sines(const RigidBodyModel<kSpatial, double>& model, double t,
                                       const Five& fault) {
  Five q;
  Five dq;
  Five ddq;
  for (Eigen::Index i = 0; i < kSpatial; ++i) {
    const double rate = 1.5 + 0.4 * static_cast<double>(i);
    q[i] = 0.3 * std::sin(rate * t);
    dq[i] = 0.3 * rate * std::cos(rate * t);
    ddq[i] = -0.3 * rate * rate * std::sin(rate * t);
  }
  const Five tau = inverse_dynamics(model, q, dq, ddq, t) - fault;
  return {q.cast<Scalar>(), dq.cast<Scalar>(), tau.cast<Scalar>()};
}

template <typename Scalar>
class MonitorInTorqueSpace : public testing::Test {
 protected:
  using Watch = SpatialWatch<Scalar>;

  void SetUp() override {
    std::mt19937_64 generator = seeded_generator();
    config = spatial_config<double>(generator);
    model = make_model(config.chain);
    std::mt19937_64 again = seeded_generator();
    ASSERT_EQ(Watch::create(spatial_config<Scalar>(again), monitor), Status::kOk);
    ASSERT_EQ(monitor.reset(on_sines<Scalar>(model, 0, Five::Zero()), state), Status::kOk);
  }
  void tick(const Five& fault) {
    time_s += 0.001;
    ASSERT_EQ(monitor.step(on_sines<Scalar>(model, time_s, fault), state, output), Status::kOk);
  }

  SpatialConfig<double> config;
  RigidBodyModel<kSpatial, double> model;
  Watch monitor;
  typename Watch::State state;
  typename Watch::Output output;
  double time_s = 0;
};
using BothScalars = testing::Types<float, double>;
TYPED_TEST_SUITE(MonitorInTorqueSpace, BothScalars);

TYPED_TEST(MonitorInTorqueSpace, GivenAHealthyArmThenNothingIsDetectedAndNothingLearnt) {
  for (int tick = 0; tick < 3000; ++tick) {
    this->tick(Five::Zero());
    ASSERT_FALSE(this->output.detector.level);
    ASSERT_TRUE(this->output.psi_hat.isZero(0));
    ASSERT_TRUE(this->output.compensation.torque.isZero(0));
    ASSERT_LT(this->output.error.norm(), TypeParam(0.02)) << "N m, of lines between the samples";
  }
  EXPECT_NEAR(this->output.thresholds[3], TypeParam(0.5), TypeParam(1e-4)) << "the bound itself";
}

TYPED_TEST(MonitorInTorqueSpace, GivenAFaultOfOneJointThenThatJointSaysItsSizeAndIsCompensated) {
  const Eigen::Index faulty = 2;
  Five fault = Five::Zero();
  for (int tick = 0; tick < 8000; ++tick) {
    if (tick == 1000) fault[faulty] = 4;
    this->tick(fault);
    const auto& joints = this->output.detector.joints;
    for (Eigen::Index i = 0; i < kSpatial; ++i) {
      ASSERT_TRUE(i == faulty || !joints[static_cast<std::size_t>(i)].level);
      ASSERT_TRUE(i == faulty || this->output.psi_hat[i] == 0);
    }
    ASSERT_EQ(this->output.detector.level, joints[faulty].level);
    if (this->output.detector.level) {
      ASSERT_EQ(this->output.error_norm, std::fabs(this->output.error[faulty]));
      ASSERT_EQ(this->output.threshold, this->output.thresholds[faulty]);
    }
  }
  EXPECT_EQ(this->output.detector.first_joint, faulty);
  EXPECT_GT(this->output.detector.detection_tick, 1000U);
  EXPECT_LT(this->output.detector.detection_tick, 1030U);
  // What acts on the joint beside the model; the drive has to give less by its scale.
  const auto psi_hat = static_cast<double>(this->output.psi_hat[faulty]);
  EXPECT_GT(psi_hat, 2.5);
  EXPECT_LT(psi_hat, 6);
  EXPECT_NEAR(static_cast<double>(this->output.compensation.torque[faulty]),
              -static_cast<double>(this->monitor.model().told_per_given[faulty]) * psi_hat, 1e-5);
}

// To the bit: no inverse of the mass matrix mixes the joints.
TEST(MonitorInTorques, GivenAFaultOfOneJointThenTheOthersResidualsAreThoseWithoutIt) {
  std::mt19937_64 generator = seeded_generator();
  const SpatialConfig<double> config = spatial_config<double>(generator);
  const auto model = make_model(config.chain);
  SpatialWatch<double> monitor;
  ASSERT_EQ(SpatialWatch<double>::create(config, monitor), Status::kOk);
  for (Eigen::Index faulty = 0; faulty < kSpatial; ++faulty) {
    SpatialWatch<double>::State healthy;
    SpatialWatch<double>::State state;
    SpatialWatch<double>::Output output;
    SpatialWatch<double>::Output without;
    const auto first = on_sines<double>(model, 0, Five::Zero());
    ASSERT_EQ(monitor.reset(first, healthy), Status::kOk);
    ASSERT_EQ(monitor.reset(first, state), Status::kOk);
    for (int tick = 1; tick < 400; ++tick) {
      const Five fault = (tick > 100 ? 3.0 : 0.0) * Five::Unit(faulty);
      const double t = 0.001 * tick;
      ASSERT_EQ(monitor.step(on_sines<double>(model, t, Five::Zero()), healthy, without),
                Status::kOk);
      ASSERT_EQ(monitor.step(on_sines<double>(model, t, fault), state, output), Status::kOk);
      for (Eigen::Index i = 0; i < kSpatial; ++i) {
        ASSERT_TRUE(i == faulty || output.error[i] == without.error[i]);
      }
    }
    EXPECT_EQ(output.detector.first_joint, faulty);
  }
}

TYPED_TEST(MonitorInTorqueSpace, GivenAMomentumErrorThenItsThresholdIsTwiceItHigherFromTheStart) {
  std::mt19937_64 generator = seeded_generator();
  auto inexact = spatial_config<TypeParam>(generator);
  inexact.bound.joints[1].momentum_error = TypeParam(0.25);
  SpatialWatch<TypeParam> tolerant;
  ASSERT_EQ(SpatialWatch<TypeParam>::create(inexact, tolerant), Status::kOk);
  const auto sample = on_sines<TypeParam>(this->model, 0, Five::Zero());
  ASSERT_EQ(tolerant.reset(sample, this->state), Status::kOk);
  const TypeParam first = TypeParam(0.5) / inexact.estimator.alpha;
  EXPECT_EQ(this->state.estimator.mu[1], TypeParam(0.5) + first);
  EXPECT_EQ(this->state.estimator.mu[2], first);
  ASSERT_EQ(tolerant.resume(sample, 5, this->state), Status::kOk);
  EXPECT_EQ(this->state.estimator.mu[1], TypeParam(1) + first) << "once more behind a gap";
  ASSERT_EQ(tolerant.reset(sample, this->state), Status::kOk);
  for (int tick = 0; tick < 2000; ++tick) {
    ASSERT_EQ(tolerant.step(sample, this->state, this->output), Status::kOk);
  }
  EXPECT_NEAR(this->output.thresholds[1] - this->output.thresholds[2], TypeParam(5),
              TypeParam(1e-3));
}

// What the model lacks at a reversal lasts for some ticks, and a run may begin in them.
TYPED_TEST(MonitorInTorqueSpace, GivenAStartOnTheMoveThenItsFirstTicksMayErrAsMuchAsAnySpeed) {
  std::mt19937_64 generator = seeded_generator();
  auto watched = spatial_config<TypeParam>(generator);
  JointBound<TypeParam>& bound = watched.bound.joints[1];
  bound.points = 2;
  bound.at = {TypeParam(0), TypeParam(0.2)};
  bound.value = {TypeParam(4), TypeParam(0.2)};
  ASSERT_EQ(SpatialWatch<TypeParam>::create(watched, this->monitor), Status::kOk);
  const auto at = [&](int tick, double torque) {
    return on_sines<TypeParam>(this->model, 0.001 * tick, torque * Five::Unit(1));
  };
  ASSERT_EQ(this->monitor.reset(at(0, 2), this->state), Status::kOk);
  EXPECT_EQ(this->state.estimator.mu[1], TypeParam(4) / watched.estimator.alpha);
  for (int tick = 1; tick < 300; ++tick) {
    ASSERT_EQ(this->monitor.step(at(tick, tick < 50 ? 2 : 0), this->state, this->output),
              Status::kOk);
    ASSERT_FALSE(this->output.detector.level) << tick;
  }
  ASSERT_LT(this->output.thresholds[1], TypeParam(0.6)) << "it has faded";
  for (int tick = 300; tick < 350; ++tick) {
    ASSERT_EQ(this->monitor.step(at(tick, 2), this->state, this->output), Status::kOk);
  }
  EXPECT_TRUE(this->output.detector.level) << "the same later is none of the bound's";
}

TYPED_TEST(MonitorInTorqueSpace, GivenGapsThatItKnowsOfThenAHealthyArmRaisesNoAlarm) {
  int without_knowing = 0;
  auto ignorant = this->state;
  typename SpatialWatch<TypeParam>::Output other;
  for (int i = 0; i < 400; ++i) {
    const std::uint32_t missed = i % 7 == 0 ? 12 : 0;
    this->time_s += 0.001 * missed;
    if (missed == 0) {
      this->tick(Five::Zero());
      ASSERT_FALSE(this->output.detector.level);
    } else {
      this->time_s += 0.001;
      const auto sample = on_sines<TypeParam>(this->model, this->time_s, Five::Zero());
      ASSERT_EQ(this->monitor.resume(sample, missed, this->state), Status::kOk);
    }
    const auto sample = on_sines<TypeParam>(this->model, this->time_s, Five::Zero());
    ASSERT_EQ(this->monitor.step(sample, ignorant, other), Status::kOk);
    without_knowing += other.detector.level ? 1 : 0;
  }
  EXPECT_GT(without_knowing, 0);
}

TYPED_TEST(MonitorInTorqueSpace, GivenASampleTooLargeToJudgeThenItIsRefusedAndNothingChanges) {
  this->tick(Five::Zero());
  auto sample = on_sines<TypeParam>(this->model, this->time_s, Five::Zero());
  const auto omega = this->state.estimator.omega;
  sample.tau[1] = std::numeric_limits<TypeParam>::max() / 4;
  EXPECT_EQ(this->monitor.step(sample, this->state, this->output), Status::kNumericOverflow);
  sample.tau[1] = 0;
  sample.dq[1] = std::sqrt(std::numeric_limits<TypeParam>::max()) / 10;
  EXPECT_EQ(this->monitor.step(sample, this->state, this->output), Status::kNumericOverflow);
  EXPECT_EQ(this->state.estimator.omega, omega);
  EXPECT_EQ(this->state.tick, 1U);
}

// The momentum of a slide under a held force is linear inside a tick: no error of interpolation.
TEST(MonitorInTorques, GivenAHeldTorqueThatJumpsThenOnlyAMonitorThatKnowsItMakesNoError) {
  using Slide = Monitor<1, 4, double, WithoutMemory, TorqueSpace>;
  const auto largest_error = [](TorqueSignal signal) {
    std::mt19937_64 generator = seeded_generator();
    Slide::Config config;
    config.chain.gravity_m_s2 = {0, 0, 0};
    config.chain.joints[0].type = JointType::kPrismatic;
    config.chain.joints[0].mass_kg = 2;
    config.estimator.hidden_units = 4;
    config.bound.joints[0].value[0] = 100;
    config.torque_signal = signal;
    Slide monitor;
    EXPECT_EQ(Slide::create(config, monitor), Status::kOk);
    Slide::State state;
    Slide::Output output;
    JointSample<1, double> sample;
    EXPECT_EQ(monitor.reset(sample, state), Status::kOk);
    double largest = 0;
    for (int tick = 0; tick < 500; ++tick) {
      sample.tau[0] = uniform(generator, -8, 8);
      sample.dq[0] += sample.tau[0] / 2 * config.estimator.period_s;
      EXPECT_EQ(monitor.step(sample, state, output), Status::kOk);
      largest = std::max(largest, output.error_norm);
    }
    return largest;
  };
  EXPECT_LT(largest_error(TorqueSignal::kHeld), 1e-11);
  EXPECT_GT(largest_error(TorqueSignal::kSampled), 1e-2) << "half a tick late";
}

TEST(JointBoundOfAMonitor, IsATableOverTheJointsOwnSpeedAndRefusedWhereItIsNone) {
  JointBound<double> bound;
  bound.points = 3;
  bound.at = {0.5, 1, 3};
  bound.value = {2, 4, 3};
  EXPECT_EQ(validate(bound), Status::kOk);
  EXPECT_EQ(evaluate(bound, 0.0), 2);
  EXPECT_EQ(evaluate(bound, 0.75), 3);
  EXPECT_EQ(evaluate(bound, 2.0), 3.5);
  EXPECT_EQ(evaluate(bound, 9.0), 3);
  const auto refused = [&](auto spoil) {
    JointBound<double> spoilt = bound;
    spoil(spoilt);
    return validate(spoilt) == Status::kInvalidBound;
  };
  EXPECT_TRUE(refused([](auto& b) { b.points = 0; }));
  EXPECT_TRUE(refused([](auto& b) { b.points = 9; }));
  EXPECT_TRUE(refused([](auto& b) { b.at[1] = 0.5; }));
  EXPECT_TRUE(refused([](auto& b) { b.value[2] = 0; }));
  EXPECT_TRUE(refused([](auto& b) { b.value[0] = std::nan(""); }));
  EXPECT_TRUE(refused([](auto& b) { b.momentum_error = -1; }));
  TorqueBound<kRuntimeJoints, double> of_two;
  of_two.joints.assign(2, bound);
  EXPECT_EQ(validate(of_two, 2), Status::kOk);
  EXPECT_EQ(validate(of_two, 3), Status::kWrongJointCount);
}

}  // namespace
}  // namespace offnominal::test
