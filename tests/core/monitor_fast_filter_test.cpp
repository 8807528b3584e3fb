#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <offnominal/model/inverse_dynamics.hpp>
#include <offnominal/monitor.hpp>

#include "core/model/random_chain.hpp"
#include "core/print_status.hpp"
#include "support/repetitions.hpp"
#include "support/seed.hpp"

// The second filter beside the estimator's (docs/theory.md, "Two filters").

namespace offnominal::test {
namespace {

constexpr int kSlideUnits = 4;
template <typename Scalar>
using Slide = Monitor<1, kSlideUnits, Scalar, WithoutMemory, TorqueSpace>;
using One = Vector<1, double>;

// A body of 1 kg on a rail: its momentum is its velocity, and follows what acts on it beside the
// model without any error of interpolation.
template <typename Scalar>
typename Slide<Scalar>::Config slide_config() {
  typename Slide<Scalar>::Config config;
  config.chain.gravity_m_s2 = {0, 0, 0};
  config.chain.joints[0].type = JointType::kPrismatic;
  config.chain.joints[0].mass_kg = 1;
  config.estimator.hidden_units = kSlideUnits;
  config.bound.joints[0].value[0] = 2;
  config.bound.fast.alpha = 80;
  config.bound.fast.joints[0].value[0] = 5;
  config.max_compensation.fill(Scalar(100));
  return config;
}

template <typename Scalar>
class SlideRun {
 public:
  explicit SlideRun(const typename Slide<Scalar>::Config& config) {
    EXPECT_EQ(Slide<Scalar>::create(config, monitor), Status::kOk);
    EXPECT_EQ(monitor.reset(sample, state), Status::kOk);
  }
  // N beside the model, for one tick.
  void tick(double force) {
    velocity_ += 0.001 * force;
    sample.dq[0] = static_cast<Scalar>(velocity_);
    ASSERT_EQ(monitor.step(sample, state, output), Status::kOk);
  }

  Slide<Scalar> monitor;
  typename Slide<Scalar>::State state;
  typename Slide<Scalar>::Output output;
  JointSample<1, Scalar> sample;

 private:
  double velocity_ = 0;
};

template <typename Scalar>
class FastFilterOf : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(FastFilterOf, Scalars);

// To rounding it is the estimator of a monitor that has its pole and learns nothing.
TEST(FastFilter, GivenNoLearningThenItIsTheEstimatorWithItsPole) {
  std::mt19937_64 generator = seeded_generator();
  constexpr int kJoints = 4;
  using Arm = Monitor<kJoints, 3, double, WithoutMemory, TorqueSpace>;
  for (const TorqueSignal signal : {TorqueSignal::kSampled, TorqueSignal::kHeld}) {
    Arm::Config config;
    config.chain = random_chain<kJoints, double>(generator);
    config.estimator.hidden_units = 3;
    config.estimator.learning_rate = 0;
    config.torque_signal = signal;
    config.bound.fast.alpha = 70;
    for (std::size_t i = 0; i < kJoints; ++i) {
      JointBound<double>& bound = config.bound.fast.joints[i];
      bound.variable = static_cast<BoundVariable>(i % 3);
      bound.points = 2;
      bound.at = {0.1, 0.6};
      bound.value = {2, 5};
      bound.momentum_error = 0.01 * static_cast<double>(i);
    }
    Arm::Config alone = config;
    alone.estimator.alpha = 70;
    alone.bound.joints = config.bound.fast.joints;
    alone.bound.fast = {};
    Arm both;
    Arm one;
    ASSERT_EQ(Arm::create(config, both), Status::kOk);
    ASSERT_EQ(Arm::create(alone, one), Status::kOk);
    Arm::State of_both;
    Arm::State of_one;
    Arm::Output output;
    Arm::Output expected;
    const auto sample_at = [&](int tick) {
      JointSample<kJoints, double> sample;
      for (Eigen::Index i = 0; i < kJoints; ++i) {
        const double phase = 0.002 * tick * static_cast<double>(i + 1);
        sample.q[i] = std::sin(phase);
        sample.dq[i] = std::cos(phase);
      }
      sample.tau = random_vector<kJoints, double>(generator, 20);
      return sample;
    };
    const auto first = sample_at(0);
    ASSERT_EQ(both.reset(first, of_both), Status::kOk);
    ASSERT_EQ(one.reset(first, of_one), Status::kOk);
    for (int tick = 1; tick < 500; ++tick) {
      const auto sample = sample_at(tick);
      if (tick % 50 == 0) {
        ASSERT_EQ(both.resume(sample, 2, of_both), Status::kOk);
        ASSERT_EQ(one.resume(sample, 2, of_one), Status::kOk);
        continue;
      }
      ASSERT_EQ(both.step(sample, of_both, output), Status::kOk);
      ASSERT_EQ(one.step(sample, of_one, expected), Status::kOk);
      const double size = expected.error.cwiseAbs().maxCoeff();
      ASSERT_LT((output.fast_error - expected.error).norm(), 1e-9 * (1 + size)) << tick;
      ASSERT_LT((output.fast_thresholds - expected.thresholds).norm(), 1e-9) << tick;
    }
  }
}

// Robustness of both filters at once, and of the network that only one of them teaches.
TEST(FastFilter, RaisesNoAlarmInAThousandUncertaintiesWithinBothBounds) {
  std::mt19937_64 generator = seeded_generator();
  constexpr double kWithin = 1 - 1e-9;
  for (int run = 0; run < repetitions(1000); ++run) {
    auto config = slide_config<double>();
    config.estimator.alpha = uniform(generator, 2, 20);
    config.bound.fast.alpha = uniform(generator, 21, 300);
    const double bound = uniform(generator, 0.1, 20);
    config.bound.joints[0].value[0] = bound;
    config.bound.fast.joints[0].value[0] = bound;
    SlideRun<double> slide(config);
    double force = 0;
    for (int tick = 0; tick < 250; ++tick) {
      if (uniform(generator, 0, 1) < 0.05) {
        force = kWithin * (uniform(generator, 0, 1) < 0.5 ? std::copysign(bound, force - 1e-9)
                                                          : uniform(generator, -bound, bound));
      }
      slide.tick(force);
      ASSERT_FALSE(slide.output.detector.latched) << "run " << run;
    }
  }
}

TYPED_TEST(FastFilterOf, SeesAShortPushThatTheSlowOneDoesNotAndTheSlowOneWhatIsSmallAndLasts) {
  auto config = slide_config<TypeParam>();
  config.estimator.learning_rate = 0;
  SlideRun<TypeParam> pushed(config);
  for (int tick = 0; tick < 400; ++tick) pushed.tick(tick >= 300 && tick < 318 ? 9 : 0);
  EXPECT_TRUE(pushed.output.detector.latched);
  EXPECT_GE(pushed.output.detector.detection_tick, 310U);
  EXPECT_LE(pushed.output.detector.detection_tick, 313U) << "ln(9 / 4) / 80 s";
  config.bound.fast = {};
  SlideRun<TypeParam> slow_alone(config);
  for (int tick = 0; tick < 400; ++tick) slow_alone.tick(tick >= 300 && tick < 318 ? 9 : 0);
  EXPECT_FALSE(slow_alone.output.detector.latched);

  SlideRun<TypeParam> loaded(slide_config<TypeParam>());
  for (int tick = 0; tick < 700; ++tick) loaded.tick(tick >= 300 ? 2.5 : 0);
  EXPECT_TRUE(loaded.output.detector.latched);
  EXPECT_GT(loaded.output.detector.detection_tick, 450U) << "ln(5) / 10 s";
}

TYPED_TEST(FastFilterOf, SaysErrorAndThresholdOfTheFilterThatIsNearer) {
  SlideRun<TypeParam> slide(slide_config<TypeParam>());
  for (int tick = 0; tick < 20; ++tick) slide.tick(4);
  const auto& output = slide.output;
  const auto ratio = [](TypeParam e, TypeParam mu) { return std::fabs(e) / mu; };
  ASSERT_GT(ratio(output.fast_error[0], output.fast_thresholds[0]),
            ratio(output.error[0], output.thresholds[0]));
  EXPECT_EQ(output.error_norm, std::fabs(output.fast_error[0]));
  EXPECT_EQ(output.threshold, output.fast_thresholds[0]);
  EXPECT_NEAR(output.fast_error[0], TypeParam(4 * -std::expm1(-80 * 0.02)), TypeParam(0.01));
}

// What the network has learnt is none of the fast filter's matter any more.
TYPED_TEST(FastFilterOf, KnowsWhatTheNetworkHasLearnt) {
  auto config = slide_config<TypeParam>();
  config.estimator.learning_rate = 200;
  SlideRun<TypeParam> slide(config);
  for (int tick = 0; tick < 6000; ++tick) slide.tick(tick >= 300 ? 12 : 0);
  EXPECT_GT(slide.output.psi_hat[0], TypeParam(8));
  EXPECT_LT(std::fabs(slide.output.fast_error[0]), TypeParam(4));
}

TYPED_TEST(FastFilterOf, GivenTwoLevelsThenItCompensatesBeyondTheSecondAlone) {
  auto config = slide_config<TypeParam>();
  config.estimator.learning_rate = 50;
  config.bound.joints[0].act_ratio = 2;
  config.bound.fast.joints[0].act_ratio = 4;
  SlideRun<TypeParam> slide(config);
  for (int tick = 0; tick < 3000; ++tick) {
    slide.tick(tick >= 300 ? 3 : 0);
    ASSERT_TRUE(slide.output.compensation.torque.isZero(0));
  }
  EXPECT_TRUE(slide.output.detector.latched);
  EXPECT_FALSE(slide.output.detector.acts);
  EXPECT_NE(slide.output.psi_hat[0], TypeParam(0)) << "it learns of what it has noticed";
  for (int tick = 0; tick < 1000; ++tick) slide.tick(15);
  EXPECT_TRUE(slide.output.detector.acts);
  EXPECT_LT(slide.output.compensation.torque[0], TypeParam(0));
}

TYPED_TEST(FastFilterOf, GivenGapsThenAHealthyBodyRaisesNoAlarm) {
  SlideRun<TypeParam> slide(slide_config<TypeParam>());
  for (int i = 0; i < 600; ++i) {
    if (i % 7 == 0) {
      slide.sample.dq[0] += TypeParam(0.3);  // what it came to meanwhile
      ASSERT_EQ(slide.monitor.resume(slide.sample, 12, slide.state), Status::kOk);
    }
    ASSERT_EQ(slide.monitor.step(slide.sample, slide.state, slide.output), Status::kOk);
    ASSERT_FALSE(slide.output.detector.latched) << i;
  }
}

TYPED_TEST(FastFilterOf, RefusesAPoleThatIsNoFasterOneOrThatNoTickFollows) {
  const auto status_of = [](TypeParam alpha) {
    auto config = slide_config<TypeParam>();
    config.bound.fast.alpha = alpha;
    Slide<TypeParam> monitor;
    const Status status = Slide<TypeParam>::create(config, monitor);
    EXPECT_EQ((validate<kSlideUnits, 1, TypeParam>(config)), status);
    return status;
  };
  EXPECT_EQ(status_of(TypeParam(0)), Status::kOk) << "none";
  EXPECT_EQ(status_of(TypeParam(10)), Status::kInvalidFilterPole);
  EXPECT_EQ(status_of(TypeParam(-80)), Status::kInvalidFilterPole);
  EXPECT_EQ(status_of(std::numeric_limits<TypeParam>::quiet_NaN()), Status::kInvalidFilterPole);
  EXPECT_EQ(status_of(TypeParam(1001)), Status::kUnstablePeriod);
  auto config = slide_config<TypeParam>();
  config.bound.fast.joints[0].value[0] = 0;
  Slide<TypeParam> monitor;
  EXPECT_EQ(Slide<TypeParam>::create(config, monitor), Status::kInvalidBound);
  config = slide_config<TypeParam>();
  config.bound.joints[0].act_ratio = TypeParam(0.9);
  EXPECT_EQ(Slide<TypeParam>::create(config, monitor), Status::kInvalidBound);
}

// Over its own load, position or speed, and nothing else.
TEST(JointBound, IsOverTheVariableThatItNames) {
  PerJoint<3, JointBound<double>> bounds{};
  for (std::size_t i = 0; i < 3; ++i) {
    bounds[i].variable = static_cast<BoundVariable>(i);
    bounds[i].points = 2;
    bounds[i].at = {-1, 1};
    bounds[i].value = {1, 3};
  }
  const Vector<3, double> q(-0.5, 9, 9);
  const Vector<3, double> dq(9, -0.5, 9);
  const Vector<3, double> tau(9, 9, -0.25);
  EXPECT_EQ((evaluate<3, double>(bounds, q, dq, tau)), (Vector<3, double>(1.5, 2.5, 2.25)));
  EXPECT_TRUE(follows_torque(bounds));
  bounds[2].points = 1;
  EXPECT_FALSE(follows_torque(bounds));
}

}  // namespace
}  // namespace offnominal::test
