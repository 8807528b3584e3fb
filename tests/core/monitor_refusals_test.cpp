#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <offnominal/monitor.hpp>
#include <string>
#include <vector>

#include "core/diagnosis/state_bits.hpp"
#include "core/monitor_of.hpp"
#include "core/print_status.hpp"

namespace offnominal::test {
namespace {

// Just above what a measured torque may be, in float too.
constexpr double kBeyondMargin = (1 + kTorqueMargin) * 1.0001;

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
      all.push_back({"torque" + to_bad,
                     [=](Sample& s) { s.tau[joint] = beyond(kMaxTorque * kBeyondMargin); },
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
class MonitorRefusals : public MonitorOf<Scalar> {};
TYPED_TEST_SUITE(MonitorRefusals, Scalars);

TYPED_TEST(MonitorRefusals, GivenABadSampleThenItsOwnStatusAndNoBitChangesAndTheNextGoodOneGoesOn) {
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

TYPED_TEST(MonitorRefusals, ASampleAtItsLimitsIsBelieved) {
  JointSample<kArmJoints, TypeParam> sample;
  sample.q << static_cast<TypeParam>(kMaxPosition), static_cast<TypeParam>(-kMaxPosition);
  sample.dq << static_cast<TypeParam>(kMaxVelocity), static_cast<TypeParam>(-kMaxVelocity);
  sample.tau << static_cast<TypeParam>(kMaxTorque), static_cast<TypeParam>(-kMaxTorque);
  EXPECT_EQ(this->monitor.reset(sample, this->state), Status::kOk);
}

// What is commanded has its limit; a drive at it gives a little more.
TYPED_TEST(MonitorRefusals, AMeasuredTorqueIsBelievedALittleBeyondItsLimit) {
  JointSample<kArmJoints, TypeParam> sample;
  const double most = kMaxTorque * (1 + kTorqueMargin) * 0.9999;
  sample.tau << static_cast<TypeParam>(most), static_cast<TypeParam>(-most);
  EXPECT_EQ(this->monitor.reset(sample, this->state), Status::kOk);
}

TYPED_TEST(MonitorRefusals, GivenNoConfigurationOrNoResetThenItIsNotInitialised) {
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

TYPED_TEST(MonitorRefusals,
           GivenAModelWithoutInertiaThenItsMassMatrixIsReportedAndTheStateUntouched) {
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

// Samples good and bad in any order: what is refused might as well not have come.
TYPED_TEST(MonitorRefusals, GivenRandomlyMixedBadSamplesThenTheGoodOnesAloneDecide) {
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

TYPED_TEST(MonitorRefusals, GivenAHeldTorqueBeyondAllReasonThenItIsRefusedAndNoBitChanges) {
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

// GIVEN joints whose number is known at run time only WHEN something is of another number of them
// THEN it is refused.
TEST(MonitorAtRunTime, RefusesWhatIsOfAnotherNumberOfJoints) {
  using Watch = Monitor<kRuntimeJoints, 4, float>;
  constexpr std::size_t kJoints = 3;
  Watch::Config config;
  config.estimator.hidden_units = 4;
  EXPECT_EQ(validate<4>(config), Status::kWrongJointCount) << "no joint";
  config.chain.joints.assign(kJoints, {});
  for (Joint<float>& joint : config.chain.joints) joint.inertia_kg_m2 = {1, 1, 1, 0, 0, 0};
  EXPECT_EQ(validate<4>(config), Status::kWrongJointCount) << "limits";
  config.max_compensation.assign(kJoints, 1);
  EXPECT_EQ(validate<4>(config), Status::kOk);
  config.bound.kind = BoundKind::kScaledNorm;
  config.bound.matrix.assign(kJoints * kJoints - 1, 1);
  EXPECT_EQ(validate<4>(config), Status::kWrongJointCount) << "matrix";
  config.bound.kind = BoundKind::kTable;
  config.bound.points = 1;
  config.bound.value[0] = 1;
  config.bound.joint = kJoints;
  EXPECT_EQ(validate<4>(config), Status::kInvalidBound);
  config.bound.joint = kJoints - 1;

  Watch monitor;
  ASSERT_EQ(Watch::create(config, monitor), Status::kOk);
  Watch::State state;
  Watch::Output output;
  Watch::Sample sample;
  EXPECT_EQ(monitor.reset(sample, state), Status::kWrongJointCount);
  size_for(kJoints, sample.q, sample.dq, sample.tau);
  EXPECT_EQ(monitor.reset(sample, state), Status::kOk);
  for (auto* values : {&sample.q, &sample.dq, &sample.tau}) {
    values->setZero(kJoints + 1);
    EXPECT_EQ(monitor.step(sample, state, output), Status::kWrongJointCount);
    values->setZero(kJoints);
  }
  EXPECT_EQ(monitor.step(sample, state, output), Status::kOk);
}

}  // namespace
}  // namespace offnominal::test
