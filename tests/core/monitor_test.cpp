#include <gtest/gtest.h>

#include <cmath>
#include <offnominal/diagnosis/position_step.hpp>
#include <offnominal/monitor.hpp>
#include <random>
#include <vector>

#include "core/monitor_of.hpp"
#include "core/print_status.hpp"

namespace offnominal::test {
namespace {

TYPED_TEST_SUITE(MonitorOf, Scalars);

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
  EXPECT_NEAR(this->output.time_s, 5.0, 1e-6);
}

TYPED_TEST(MonitorOf, GivenAFaultThenItIsDetectedLearntAndCompensated) {
  WatchedArm<TypeParam> arm;
  ASSERT_EQ(this->monitor.reset(arm.sample(), this->state), Status::kOk);
  const int fault_tick = 1000;
  std::uint64_t first_level = 0;
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
  EXPECT_GT(first_level, static_cast<std::uint64_t>(fault_tick));
  EXPECT_LT(first_level, static_cast<std::uint64_t>(fault_tick) + 300U);
  EXPECT_EQ(this->output.detector.detection_tick, first_level);
  EXPECT_NEAR(this->output.detector.detection_time_s, 0.001 * static_cast<double>(first_level),
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
  const std::uint64_t first = this->state.detector.detection_tick;
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

// A joint whose position is elsewhere from one tick to the next, farther than it ever comes.
TYPED_TEST(MonitorOf, GivenAPositionToWhichNoMotionComesThenThatTickIsBeyond) {
  WatchedArm<TypeParam> arm;
  auto config = arm_config<TypeParam>();
  config.bound.offset = 1000;
  typename WatchedArm<TypeParam>::Watch blind;
  ASSERT_EQ(WatchedArm<TypeParam>::Watch::create(config, blind), Status::kOk);
  ASSERT_EQ(blind.reset(arm.sample(), this->state), Status::kOk);
  const auto step_is_beyond = [&](TypeParam away) {
    auto sample = arm.move(0.001, 0.0);
    sample.q[1] += away;
    EXPECT_EQ(blind.step(sample, this->state, this->output), Status::kOk);
    return this->output.detector.level;
  };
  for (int tick = 0; tick < 110; ++tick) ASSERT_FALSE(step_is_beyond(0));
  EXPECT_TRUE(step_is_beyond(TypeParam(0.05)));
  EXPECT_FALSE(step_is_beyond(TypeParam(0.05)));
  EXPECT_TRUE(this->output.detector.latched);
  EXPECT_EQ(this->output.detector.detection_tick, 111U);
}

// Of a joint that stays below 1 rad/s, tick by tick of 1 ms, after a hundred ticks to and fro by
// `count`: which of these positions are jumps.
std::vector<bool> jumps_of(const std::vector<double>& positions, double max_velocity = 1,
                           double count = 0.0005) {
  PerJoint<1, Joint<double>> joints{};
  joints[0].max_velocity = max_velocity;
  PerJoint<1, KnownSteps<double>> known{};
  const auto is_jump = [&](double from, double to) {
    const Vector<1, double> before = Vector<1, double>::Constant(from);
    const Vector<1, double> now = Vector<1, double>::Constant(to);
    return take_steps<1, double>(joints, before, now, 0.001, known) != kNoJoint;
  };
  for (int tick = 0; tick < 100; ++tick) {
    EXPECT_FALSE(is_jump(tick % 2 == 0 ? 0 : count, tick % 2 == 0 ? count : 0));
  }
  std::vector<bool> jumps;
  for (std::size_t i = 1; i < positions.size(); ++i) {
    jumps.push_back(is_jump(positions[i - 1], positions[i]));
  }
  return jumps;
}

TEST(PositionStep, IsAJumpWhereTheJointCannotComeSoFar) {
  const std::vector<double> positions{0, 0.001, 0.0019, 0.006, 0.0055};
  EXPECT_EQ(jumps_of(positions), (std::vector<bool>{false, false, true, false}));
  EXPECT_EQ(jumps_of(positions, 2), (std::vector<bool>{false, false, false, false}));
}
TEST(PositionStep, IsOneAgainWhereItJumpsAgain) {
  EXPECT_EQ(jumps_of({0, 0.03, 0, 0.03}), (std::vector<bool>{true, true, true}));
}
TEST(PositionStep, IsNoneOfAJointWithoutALargestVelocity) {
  const double none = Joint<double>{}.max_velocity;
  EXPECT_EQ(jumps_of({0, 0.001, 5, -5}, none), (std::vector<bool>{false, false, false}));
}
// Counts of 0.01 rad, of which a slow joint takes one in many ticks.
TEST(PositionStep, IsNoneWhereACoarseEncoderGoesOnByACount) {
  EXPECT_EQ(jumps_of({0, 0, 0.01, 0.01, 0.02, 0.01, 0.05}, 1, 0.01),
            (std::vector<bool>{false, false, false, false, false, true}));
}
// A wire's length to a tenth of a millimetre, of a joint that moves 0.03 m/s at most.
TEST(PositionStep, IsNoneOfANoisySensor) {
  std::mt19937_64 generator = seeded_generator();
  std::normal_distribution<double> noise(0, 1e-4);
  PerJoint<1, Joint<double>> joints{};
  joints[0].max_velocity = 0.03;
  PerJoint<1, KnownSteps<double>> known{};
  Vector<1, double> before = Vector<1, double>::Zero();
  for (int tick = 0; tick < 200'000; ++tick) {
    const Vector<1, double> now = Vector<1, double>::Constant(noise(generator));
    ASSERT_EQ((take_steps<1, double>(joints, before, now, 0.001, known)), kNoJoint) << tick;
    before = now;
  }
}

}  // namespace
}  // namespace offnominal::test
