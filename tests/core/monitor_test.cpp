#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <offnominal/monitor.hpp>
#include <string>
#include <vector>

#include "core/diagnosis/state_bits.hpp"
#include "core/print_status.hpp"
#include "core/watched_arm.hpp"

namespace offnominal::test {
namespace {

template <typename Scalar>
struct BadSample {
  std::string name;
  std::function<void(JointSample<kArmJoints, Scalar>&)> spoil;
  Status status;
};

template <typename Scalar>
std::vector<BadSample<Scalar>> bad_samples() {
  using Sample = JointSample<kArmJoints, Scalar>;
  std::vector<BadSample<Scalar>> all;
  for (Eigen::Index joint = 0; joint < kArmJoints; ++joint) {
    const std::string at = " of joint " + std::to_string(joint) + " = ";
    for (const Scalar bad :
         {std::numeric_limits<Scalar>::quiet_NaN(), std::numeric_limits<Scalar>::infinity(),
          -std::numeric_limits<Scalar>::infinity()}) {
      const std::string to_bad = at + std::to_string(bad);
      all.push_back(
          {"position" + to_bad, [=](Sample& s) { s.q[joint] = bad; }, Status::kNonFinitePosition});
      all.push_back(
          {"velocity" + to_bad, [=](Sample& s) { s.dq[joint] = bad; }, Status::kNonFiniteVelocity});
      all.push_back(
          {"torque" + to_bad, [=](Sample& s) { s.tau[joint] = bad; }, Status::kNonFiniteTorque});
    }
    for (const Scalar sign : {Scalar(-1), Scalar(1)}) {
      const std::string to_bad = at + (sign > 0 ? "above" : "below");
      const auto beyond = [sign](double limit) {
        return sign * std::nextafter(static_cast<Scalar>(limit), Scalar(1e9));
      };
      all.push_back({"position" + to_bad, [=](Sample& s) { s.q[joint] = beyond(kMaxPosition); },
                     Status::kPositionOutOfRange});
      all.push_back({"velocity" + to_bad, [=](Sample& s) { s.dq[joint] = beyond(kMaxVelocity); },
                     Status::kVelocityOutOfRange});
      all.push_back({"torque" + to_bad, [=](Sample& s) { s.tau[joint] = beyond(kMaxTorque); },
                     Status::kTorqueOutOfRange});
    }
  }
  all.push_back({"not a number and out of range",
                 [](Sample& s) {
                   s.q[0] = Scalar(1e6);
                   s.tau[1] = std::numeric_limits<Scalar>::quiet_NaN();
                 },
                 Status::kNonFiniteTorque});
  return all;
}

template <typename Scalar>
class MonitorOf : public testing::Test {
 protected:
  using Watched = typename WatchedArm<Scalar>::Watch;

  void SetUp() override { ASSERT_EQ(Watched::create(arm_config<Scalar>(), monitor), Status::kOk); }

  Watched monitor;
  typename Watched::State state;
  typename Watched::Output output;
};

using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(MonitorOf, Scalars);

TYPED_TEST(MonitorOf, GivenABadSampleThenItsOwnStatusAndNoBitChangesAndTheNextGoodOneGoesOn) {
  WatchedArm<TypeParam> arm;
  ASSERT_EQ(this->monitor.reset(arm.sample(), this->state), Status::kOk);
  for (int tick = 0; tick < 1500; ++tick) {
    ASSERT_EQ(this->monitor.step(arm.move(0.001, 3.0), this->state, this->output), Status::kOk);
  }
  EXPECT_TRUE(this->state.detector.latched) << "a state worth keeping";
  auto undisturbed = this->state;
  const Bits state_before = bits_of(this->state);
  const Bits output_before = bits_of(this->output);
  for (const auto& bad : bad_samples<TypeParam>()) {
    auto sample = arm.sample();
    bad.spoil(sample);
    EXPECT_EQ(this->monitor.step(sample, this->state, this->output), bad.status) << bad.name;
    EXPECT_EQ(bits_of(this->state), state_before) << bad.name;
    EXPECT_EQ(bits_of(this->output), output_before) << bad.name;
    EXPECT_EQ(this->monitor.reset(sample, this->state), bad.status) << bad.name;
    EXPECT_EQ(bits_of(this->state), state_before) << bad.name;
  }
  const auto good = arm.move(0.001, 3.0);
  ASSERT_EQ(this->monitor.step(good, this->state, this->output), Status::kOk);
  ASSERT_EQ(this->monitor.step(good, undisturbed, this->output), Status::kOk);
  EXPECT_EQ(bits_of(this->state), bits_of(undisturbed));
}

TYPED_TEST(MonitorOf, ASampleAtItsLimitsIsBelieved) {
  JointSample<kArmJoints, TypeParam> sample;
  sample.q << static_cast<TypeParam>(kMaxPosition), static_cast<TypeParam>(-kMaxPosition);
  sample.dq << static_cast<TypeParam>(kMaxVelocity), static_cast<TypeParam>(-kMaxVelocity);
  sample.tau << static_cast<TypeParam>(kMaxTorque), static_cast<TypeParam>(-kMaxTorque);
  EXPECT_EQ(this->monitor.reset(sample, this->state), Status::kOk);
}

TYPED_TEST(MonitorOf, GivenNoConfigurationOrNoResetThenItIsNotInitialised) {
  using Watch = typename WatchedArm<TypeParam>::Watch;
  const WatchedArm<TypeParam> arm;
  const Bits state_before = bits_of(this->state);
  const Bits output_before = bits_of(this->output);
  EXPECT_EQ(this->monitor.step(arm.sample(), this->state, this->output), Status::kNotInitialised);
  Watch never_created;
  EXPECT_EQ(never_created.reset(arm.sample(), this->state), Status::kNotInitialised);
  EXPECT_EQ(never_created.step(arm.sample(), this->state, this->output), Status::kNotInitialised);
  EXPECT_EQ(bits_of(this->state), state_before);
  EXPECT_EQ(bits_of(this->output), output_before);
}

TYPED_TEST(MonitorOf, GivenAHealthyArmThenNothingIsDetectedAndNothingLearnt) {
  WatchedArm<TypeParam> arm;
  ASSERT_EQ(this->monitor.reset(arm.sample(), this->state), Status::kOk);
  for (int tick = 0; tick < 5000; ++tick) {
    ASSERT_EQ(this->monitor.step(arm.move(0.001, 0.0), this->state, this->output), Status::kOk);
    ASSERT_FALSE(this->output.detector.level);
    ASSERT_TRUE(this->output.psi_hat.isZero(0));
    ASSERT_TRUE(this->output.compensation.torque.isZero(0));
  }
  EXPECT_FALSE(this->output.detector.latched);
  EXPECT_EQ(this->state.tick, 5000U);
  EXPECT_NEAR(static_cast<double>(this->output.time_s), 5.0, 1e-6);
}

TYPED_TEST(MonitorOf, GivenAFaultThenItIsDetectedLearntAndCompensated) {
  WatchedArm<TypeParam> arm;
  ASSERT_EQ(this->monitor.reset(arm.sample(), this->state), Status::kOk);
  const int fault_tick = 1000;
  std::uint32_t first_level = 0;
  for (int tick = 0; tick < 6000; ++tick) {
    const double fault = tick < fault_tick ? 0.0 : 3.0;
    ASSERT_EQ(this->monitor.step(arm.move(0.001, fault), this->state, this->output), Status::kOk);
    if (this->output.detector.level && first_level == 0) first_level = this->state.tick;
    ASSERT_EQ(this->output.detector.latched, first_level != 0);
    ASSERT_EQ(this->output.error, this->state.estimator.error);
    ASSERT_EQ(this->output.error_norm, this->state.estimator.error.norm());
    ASSERT_EQ(this->output.threshold, this->state.estimator.mu);
    ASSERT_EQ(this->output.detector.level, this->output.error_norm > this->output.threshold);
  }
  EXPECT_GT(first_level, static_cast<std::uint32_t>(fault_tick));
  EXPECT_LT(first_level, static_cast<std::uint32_t>(fault_tick) + 300U);
  EXPECT_EQ(this->output.detector.detection_tick, first_level);
  EXPECT_NEAR(static_cast<double>(this->output.detector.detection_time_s), 0.001 * first_level,
              1e-6);
  const Eigen::Vector2d psi_hat = this->output.psi_hat.template cast<double>();
  EXPECT_LT((psi_hat - Eigen::Vector2d(3, -3)).norm(), 1.5);
  const Matrix<2, 2, TypeParam> inertia = mass_matrix(this->monitor.model(), arm.sample().q);
  const Eigen::Vector2d expected = -(inertia.template cast<double>() * psi_hat);
  EXPECT_LE((this->output.compensation.torque.template cast<double>() - expected).norm(), 1e-4);
  EXPECT_FALSE(this->output.compensation.saturated);
}

TYPED_TEST(MonitorOf, GivenNoRoomForCompensationThenItReportsAndDoesNotAct) {
  using Watch = typename WatchedArm<TypeParam>::Watch;
  auto config = arm_config<TypeParam>();
  config.max_compensation = {0, TypeParam(0.25)};
  Watch passive;
  ASSERT_EQ(Watch::create(config, passive), Status::kOk);
  WatchedArm<TypeParam> arm;
  ASSERT_EQ(passive.reset(arm.sample(), this->state), Status::kOk);
  for (int tick = 0; tick < 4000; ++tick) {
    ASSERT_EQ(passive.step(arm.move(0.001, 3.0), this->state, this->output), Status::kOk);
    ASSERT_EQ(this->output.compensation.torque[0], TypeParam(0));
    ASSERT_LE(std::fabs(this->output.compensation.torque[1]), TypeParam(0.25));
  }
  EXPECT_TRUE(this->output.detector.latched);
  EXPECT_TRUE(this->output.compensation.saturated);
}

TYPED_TEST(MonitorOf, GivenAClearedLatchThenTheSameFaultLatchesAgainAndAResetForgetsAll) {
  WatchedArm<TypeParam> arm;
  ASSERT_EQ(this->monitor.reset(arm.sample(), this->state), Status::kOk);
  for (int tick = 0; tick < 400; ++tick) {
    ASSERT_EQ(this->monitor.step(arm.move(0.001, 8.0), this->state, this->output), Status::kOk);
  }
  ASSERT_TRUE(this->state.detector.level);
  const std::uint32_t first = this->state.detector.detection_tick;
  clear_latch(this->state.detector);
  ASSERT_EQ(this->monitor.step(arm.move(0.001, 8.0), this->state, this->output), Status::kOk);
  EXPECT_TRUE(this->output.detector.latched);
  EXPECT_GT(this->output.detector.detection_tick, first);

  ASSERT_EQ(this->monitor.reset(arm.sample(), this->state), Status::kOk);
  EXPECT_FALSE(this->state.detector.latched);
  EXPECT_EQ(this->state.tick, 0U);
  EXPECT_EQ(this->state.estimator.mu, TypeParam(0));
  EXPECT_TRUE(this->state.estimator.weights.w2_transposed.isZero(0));
}

TYPED_TEST(MonitorOf, GivenAModelWithoutInertiaThenItsMassMatrixIsReportedAndTheStateUntouched) {
  using Watch = typename WatchedArm<TypeParam>::Watch;
  auto config = arm_config<TypeParam>();
  config.chain.joints[1].centre_of_mass_m = {0, 0, 0};
  Watch weightless;
  ASSERT_EQ(Watch::create(config, weightless), Status::kOk);
  const Bits before = bits_of(this->state);
  EXPECT_EQ(weightless.reset(WatchedArm<TypeParam>().sample(), this->state),
            Status::kSingularMassMatrix);
  EXPECT_EQ(bits_of(this->state), before);
}

// A healthy arm whose velocity is measured wrongly by up to `velocity_error`, in any direction.
template <typename Scalar>
int alarms_with_velocity_error(double velocity_error, double believed_error,
                               std::mt19937_64& generator) {
  using Watch = typename WatchedArm<Scalar>::Watch;
  auto config = arm_config<Scalar>();
  config.bound.velocity_error = static_cast<Scalar>(believed_error);
  Watch monitor;
  EXPECT_EQ(Watch::create(config, monitor), Status::kOk);
  WatchedArm<Scalar> arm;
  const auto mismeasured = [&](JointSample<kArmJoints, Scalar> sample) {
    const Eigen::Vector2d direction = random_direction(generator).head<2>().normalized();
    sample.dq += (velocity_error * direction).cast<Scalar>();
    return sample;
  };
  typename Watch::State state;
  typename Watch::Output output;
  EXPECT_EQ(monitor.reset(mismeasured(arm.sample()), state), Status::kOk);
  int alarms = 0;
  for (int tick = 0; tick < 3000; ++tick) {
    EXPECT_EQ(monitor.step(mismeasured(arm.move(0.001, 0.0)), state, output), Status::kOk);
    alarms += output.detector.level ? 1 : 0;
  }
  return alarms;
}

TYPED_TEST(MonitorOf, GivenAVelocityErrorThatTheBoundKnowsThenItRaisesNoAlarm) {
  std::mt19937_64 generator = seeded_generator();
  EXPECT_EQ(alarms_with_velocity_error<TypeParam>(0.05, 0.05, generator), 0);
  EXPECT_GT(alarms_with_velocity_error<TypeParam>(0.05, 0.0, generator), 0);
}

TYPED_TEST(MonitorOf, GivenAVelocityErrorThenTheThresholdIsTwiceItsSizeHigherFromTheStart) {
  using Watch = typename WatchedArm<TypeParam>::Watch;
  auto config = arm_config<TypeParam>();
  config.bound.velocity_error = TypeParam(0.25);
  Watch tolerant;
  ASSERT_EQ(Watch::create(config, tolerant), Status::kOk);
  WatchedArm<TypeParam> arm;
  auto tolerant_state = this->state;
  ASSERT_EQ(tolerant.reset(arm.sample(), tolerant_state), Status::kOk);
  ASSERT_EQ(this->monitor.reset(arm.sample(), this->state), Status::kOk);
  EXPECT_EQ(tolerant_state.estimator.mu, TypeParam(0.5));
  for (int tick = 0; tick < 1000; ++tick) {
    const auto sample = arm.move(0.001, 0.0);
    ASSERT_EQ(tolerant.step(sample, tolerant_state, this->output), Status::kOk);
    const TypeParam higher = this->output.threshold;
    ASSERT_EQ(this->monitor.step(sample, this->state, this->output), Status::kOk);
    ASSERT_NEAR(higher - this->output.threshold, TypeParam(0.5), TypeParam(1e-5));
  }
}

// Samples good and bad in any order: what is refused might as well not have come.
TYPED_TEST(MonitorOf, GivenRandomlyMixedBadSamplesThenTheGoodOnesAloneDecide) {
  std::mt19937_64 generator = seeded_generator();
  WatchedArm<TypeParam> arm;
  ASSERT_EQ(this->monitor.reset(arm.sample(), this->state), Status::kOk);
  auto undisturbed = this->state;
  auto undisturbed_output = this->output;
  const auto bad = bad_samples<TypeParam>();
  int refused = 0;
  for (int tick = 0; tick < 3000; ++tick) {
    while (uniform(generator, 0, 1) < 0.4) {
      auto sample = arm.sample();
      const auto& chosen = bad[generator() % bad.size()];
      chosen.spoil(sample);
      ASSERT_EQ(this->monitor.step(sample, this->state, this->output), chosen.status);
      ++refused;
    }
    const auto good = arm.move(0.001, 3.0);
    ASSERT_EQ(this->monitor.step(good, this->state, this->output), Status::kOk);
    ASSERT_EQ(this->monitor.step(good, undisturbed, undisturbed_output), Status::kOk);
  }
  EXPECT_GT(refused, 500);
  EXPECT_EQ(bits_of(this->state), bits_of(undisturbed));
  EXPECT_EQ(bits_of(this->output), bits_of(undisturbed_output));
}

// A slide of 2 kg under a torque that jumps at every tick and is constant in between: its velocity
// is then linear inside every tick, and so the estimator's, which owes nothing to interpolation.
class HeldSlide {
 public:
  static MonitorConfig<1, double> config(TorqueSignal signal) {
    MonitorConfig<1, double> config;
    config.chain.gravity_m_s2 = {0, 0, 0};
    config.chain.joints[0].type = JointType::kPrismatic;
    config.chain.joints[0].mass_kg = kMass;
    config.bound.kind = BoundKind::kTable;
    config.bound.variable = BoundVariable::kTorque;
    config.bound.points = 2;
    config.bound.at = {0, 10};
    config.bound.value = {1, 11};  // 1 + |tau|
    config.torque_signal = signal;
    return config;
  }

  JointSample<1, double> move(double period_s, double force) {
    sample_.q[0] += sample_.dq[0] * period_s + 0.5 * force / kMass * period_s * period_s;
    sample_.dq[0] += force / kMass * period_s;
    sample_.tau[0] = force;
    return sample_;
  }
  [[nodiscard]] const JointSample<1, double>& sample() const { return sample_; }

 private:
  static constexpr double kMass = 2;
  JointSample<1, double> sample_;
};

struct SlideErrors {
  double velocity = 0;   // largest |e|
  double threshold = 0;  // largest |mu - filtered bound|
};

SlideErrors errors_under_a_jumping_force(TorqueSignal signal) {
  using Watch = Monitor<1, 4, double>;
  std::mt19937_64 generator = seeded_generator();
  auto config = HeldSlide::config(signal);
  config.estimator.hidden_units = 4;
  Watch monitor;
  EXPECT_EQ(Watch::create(config, monitor), Status::kOk);
  HeldSlide slide;
  Watch::State state;
  Watch::Output output;
  EXPECT_EQ(monitor.reset(slide.sample(), state), Status::kOk);
  const double period = config.estimator.period_s;
  const double decay = std::exp(-config.estimator.alpha * period);
  double filtered_bound = 0;
  SlideErrors worst;
  for (int tick = 0; tick < 2000; ++tick) {
    const double force = uniform(generator, -8, 8);
    EXPECT_EQ(monitor.step(slide.move(period, force), state, output), Status::kOk);
    filtered_bound =
        decay * filtered_bound + (1 - decay) / config.estimator.alpha * (1 + std::fabs(force));
    worst.velocity = std::max(worst.velocity, output.error_norm);
    worst.threshold = std::max(worst.threshold, std::fabs(output.threshold - filtered_bound));
  }
  return worst;
}

TEST(Monitor, GivenAHeldTorqueThatJumpsThenAMonitorThatKnowsItMakesNoErrorOfItsOwn) {
  const SlideErrors held = errors_under_a_jumping_force(TorqueSignal::kHeld);
  EXPECT_LT(held.velocity, 1e-12);
  EXPECT_LT(held.threshold, 1e-9);
  const SlideErrors sampled = errors_under_a_jumping_force(TorqueSignal::kSampled);
  EXPECT_GT(sampled.velocity, 1e-3) << "half a tick late";
  EXPECT_GT(sampled.threshold, 1e-4);
}

TYPED_TEST(MonitorOf, GivenAHeldTorqueBeyondAllReasonThenItIsRefusedAndNoBitChanges) {
  using Watch = typename WatchedArm<TypeParam>::Watch;
  auto config = arm_config<TypeParam>();
  config.torque_signal = TorqueSignal::kHeld;
  for (auto& joint : config.chain.joints) joint.max_torque = std::numeric_limits<TypeParam>::max();
  Watch unlimited;
  ASSERT_EQ(Watch::create(config, unlimited), Status::kOk);
  WatchedArm<TypeParam> arm;
  auto sample = arm.sample();
  ASSERT_EQ(unlimited.reset(sample, this->state), Status::kOk);
  const Bits before = bits_of(this->state);
  sample.tau[0] = std::numeric_limits<TypeParam>::max();
  EXPECT_NE(unlimited.step(sample, this->state, this->output), Status::kOk);
  EXPECT_EQ(bits_of(this->state), before);
  EXPECT_EQ(unlimited.step(arm.move(0.001, 0.0), this->state, this->output), Status::kOk);
}

struct Refusal {
  std::string name;
  std::function<void(MonitorConfig<kArmJoints, double>&)> spoil;
  Status status;
};

class MonitorValidation : public testing::TestWithParam<Refusal> {};

TEST_P(MonitorValidation, GivenABadConfigurationThenItIsRefusedAndTheMonitorKeepsItsOwn) {
  using Watch = WatchedArm<double>::Watch;
  Watch monitor;
  ASSERT_EQ(Watch::create(arm_config<double>(), monitor), Status::kOk);
  auto config = arm_config<double>();
  config.bound.offset = 77;
  GetParam().spoil(config);
  EXPECT_EQ(Watch::create(config, monitor), GetParam().status);
  EXPECT_EQ(monitor.config().bound.offset, arm_config<double>().bound.offset);
  Watch::State state;
  EXPECT_EQ(monitor.reset(WatchedArm<double>().sample(), state), Status::kOk);
}

INSTANTIATE_TEST_SUITE_P(
    All, MonitorValidation,
    testing::Values(
        Refusal{"Chain", [](auto& c) { c.chain.joints[1].mass_kg = -1; }, Status::kInvalidMass},
        Refusal{"Estimator", [](auto& c) { c.estimator.alpha = 0; }, Status::kInvalidFilterPole},
        Refusal{"HiddenUnits", [](auto& c) { c.estimator.hidden_units = kArmHidden + 1; },
                Status::kInvalidHiddenUnits},
        Refusal{"Bound", [](auto& c) { c.bound.offset = 0; }, Status::kInvalidBound},
        Refusal{"CompensationNegative", [](auto& c) { c.max_compensation[1] = -1; },
                Status::kInvalidLimit},
        Refusal{"CompensationNaN",
                [](auto& c) { c.max_compensation[0] = std::numeric_limits<double>::quiet_NaN(); },
                Status::kInvalidLimit}),
    [](const testing::TestParamInfo<Refusal>& tested) { return tested.param.name; });

TEST(Monitor, FloatAndDoubleDetectWithinTwoTicksOfEachOtherAndAgreeOnTheFault) {
  WatchedArm<double> arm;
  WatchedArm<double>::Watch in_double;
  WatchedArm<float>::Watch in_float;
  ASSERT_EQ(WatchedArm<double>::Watch::create(arm_config<double>(), in_double), Status::kOk);
  ASSERT_EQ(WatchedArm<float>::Watch::create(arm_config<float>(), in_float), Status::kOk);
  WatchedArm<double>::Watch::State state_double;
  WatchedArm<float>::Watch::State state_float;
  WatchedArm<double>::Watch::Output output_double;
  WatchedArm<float>::Watch::Output output_float;
  const auto narrowed = [](const JointSample<kArmJoints, double>& s) {
    return JointSample<kArmJoints, float>{s.q.cast<float>(), s.dq.cast<float>(),
                                          s.tau.cast<float>()};
  };
  ASSERT_EQ(in_double.reset(arm.sample(), state_double), Status::kOk);
  ASSERT_EQ(in_float.reset(narrowed(arm.sample()), state_float), Status::kOk);
  double worst = 0;
  double largest = 0;
  for (int tick = 0; tick < 10000; ++tick) {
    const auto sample = arm.move(0.001, tick < 2000 ? 0.0 : 3.0);
    ASSERT_EQ(in_double.step(sample, state_double, output_double), Status::kOk);
    ASSERT_EQ(in_float.step(narrowed(sample), state_float, output_float), Status::kOk);
    worst = std::max(worst, (output_float.psi_hat.cast<double>() - output_double.psi_hat).norm());
    largest = std::max(largest, output_double.psi_hat.norm());
  }
  ASSERT_TRUE(output_double.detector.latched);
  ASSERT_TRUE(output_float.detector.latched);
  EXPECT_NEAR(static_cast<double>(output_double.detector.detection_tick),
              static_cast<double>(output_float.detector.detection_tick), 2);
  EXPECT_LE(worst, 0.01 * largest);
}

}  // namespace
}  // namespace offnominal::test
