#include <gtest/gtest.h>

#include <limits>
#include <offnominal/diagnosis/estimator.hpp>

#include "core/diagnosis/estimator_run.hpp"
#include "core/diagnosis/state_bits.hpp"
#include "core/model/random_chain.hpp"
#include "core/print_status.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

constexpr int kJoints = 2;
constexpr int kHidden = 35;

template <typename Scalar>
class Estimator : public testing::Test {
 protected:
  using State = EstimatorState<kJoints, kHidden, Scalar>;

  void start(const PlainSample& sample) { ASSERT_EQ(reset_at(config, sample, state), Status::kOk); }
  Status tick(const PlainSample& sample) {
    return step(config, estimator_input<kJoints, Scalar>(sample), state);
  }
  PlainSample at(double t) const { return motion.sample(t); }

  EstimatorConfig<Scalar> config;
  ExampleMotion motion{kJoints};
  State state;
};

using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(Estimator, Scalars);

TYPED_TEST(Estimator, StartsAtTheMeasuredVelocityWithoutThresholdErrorOrFaultEstimate) {
  this->start(this->at(0));
  EXPECT_EQ(this->state.omega, this->at(0).dq.template cast<TypeParam>());
  EXPECT_EQ(this->state.mu, TypeParam(0));
  EXPECT_TRUE(this->state.error.isZero(0));
  EXPECT_TRUE(this->state.psi_hat.isZero(0));
  EXPECT_TRUE(this->state.weights.w2_transposed.isZero(0));
}

TYPED_TEST(Estimator, GivenInitialWeightsOutsideOfTheBallThenTheyAreRefusedAndTheStateUntouched) {
  this->start(this->at(0));
  const Bits before = bits_of(this->state);
  this->config.weight_radius = TypeParam(0.5);
  EXPECT_EQ(reset_at(this->config, this->at(1), this->state), Status::kInvalidInitialWeights);
  EXPECT_EQ(bits_of(this->state), before);
}

// Theorem 4.1, and more: a healthy tick does not change a single bit of the weights.
TYPED_TEST(Estimator,
           GivenAHealthyRobotThenTheWeightsKeepEveryBitAndTheFaultEstimateIsExactlyZero) {
  this->motion.fault_time_s = 1e9;
  this->start(this->at(0));
  const Bits weights = bits_of(this->state.weights);
  for (int tick = 1; tick <= 5000; ++tick) {
    ASSERT_EQ(this->tick(this->at(0.001 * tick)), Status::kOk);
    ASSERT_LT(this->state.error.norm(), this->state.mu);
    ASSERT_EQ(bits_of(this->state.weights), weights);
    ASSERT_TRUE(this->state.psi_hat.isZero(0));
  }
}

// The samples and the model agree again now and then, while the network keeps what it knows.
template <typename Scalar>
void expect_learnt_weights_kept(EstimatorConfig<Scalar> config, Scalar radius) {
  config.weight_radius = radius;
  const ExampleMotion motion{kJoints};
  EstimatorState<kJoints, kHidden, Scalar> state;
  ASSERT_EQ(reset_at(config, motion.sample(0), state), Status::kOk);
  int kept = 0;
  int moved = 0;
  for (int tick = 1; tick <= 12000; ++tick) {
    const Bits weights = bits_of(state.weights);
    const bool began_within = state.error.norm() < Scalar(0.98) * state.mu;
    const auto input = estimator_input<kJoints, Scalar>(motion.sample(0.001 * tick));
    ASSERT_EQ(step(config, input, state), Status::kOk);
    const bool ended_within = state.error.norm() < Scalar(0.98) * state.mu;
    const bool same = bits_of(state.weights) == weights;
    if (tick > 2500 && began_within && ended_within) {
      ASSERT_TRUE(same) << tick;
      ++kept;
    }
    moved += same ? 0 : 1;
  }
  EXPECT_GT(kept, 100);
  EXPECT_GT(moved, 500);
}

TYPED_TEST(Estimator, GivenAnErrorBackWithinTheThresholdThenTheLearntWeightsKeepEveryBit) {
  expect_learnt_weights_kept<TypeParam>(this->config, 10);
}

TYPED_TEST(Estimator, GivenAnErrorBackWithinTheThresholdOnTheBallThenTheLearntWeightsKeepEveryBit) {
  expect_learnt_weights_kept<TypeParam>(this->config, TypeParam(2.5));
}

TYPED_TEST(Estimator, GivenALearningRateOfZeroThenItDetectsButNeverLearns) {
  this->config.learning_rate = 0;
  this->start(this->at(0));
  const Bits weights = bits_of(this->state.weights);
  bool detected = false;
  for (int tick = 1; tick <= 5000; ++tick) {
    ASSERT_EQ(this->tick(this->at(0.001 * tick)), Status::kOk);
    detected = detected || this->state.error.norm() > this->state.mu;
  }
  EXPECT_TRUE(detected);
  EXPECT_EQ(bits_of(this->state.weights), weights);
  EXPECT_TRUE(this->state.psi_hat.isZero(0));
}

TYPED_TEST(Estimator, UnitsThatAreNotInUseStayExactlyZero) {
  this->config.hidden_units = 5;
  this->start(this->at(0));
  for (int tick = 1; tick <= 5000; ++tick) {
    ASSERT_EQ(this->tick(this->at(0.001 * tick)), Status::kOk);
  }
  EXPECT_FALSE(this->state.weights.w2_transposed.template topRows<5>().isZero(0));
  const Eigen::Index unused = this->state.weights.w1.rows() - 5;
  EXPECT_TRUE(this->state.weights.w1.bottomRows(unused).isZero(0));
  EXPECT_TRUE(this->state.weights.w2_transposed.bottomRows(unused).isZero(0));
}

// What is carried from tick to tick instead of being computed anew must not drift.
TYPED_TEST(Estimator, WhatItCarriesAlongStaysTrueToTheWeights) {
  this->start(this->at(0));
  for (int tick = 1; tick <= 20000; ++tick) {
    ASSERT_EQ(this->tick(this->at(0.001 * tick)), Status::kOk);
  }
  const auto& ended = this->state;
  const Eigen::MatrixXd w1 = ended.weights.w1.template cast<double>();
  const Eigen::VectorXd z = ended.z.template cast<double>();
  const double tolerance = 1000 * static_cast<double>(std::numeric_limits<TypeParam>::epsilon());
  EXPECT_LE(deviation(ended.w1_z.matrix(), w1 * z), tolerance);
  EXPECT_NEAR(static_cast<double>(ended.z_squared_norm), z.squaredNorm(),
              tolerance * z.squaredNorm());
  const double norm = weight_norm(ended.weights);
  EXPECT_NEAR(static_cast<double>(ended.theta_squared_norm), norm * norm, tolerance * norm * norm);
  EXPECT_LE(deviation(ended.psi_hat, network_output(ended.weights, ended.z)), tolerance);
  EXPECT_EQ(ended.error, (ended.z.template segment<kJoints>(1 + kJoints) - ended.omega).eval());
}

TYPED_TEST(Estimator, GivenASignalTooLargeForTheScalarThenItIsRefusedAndTheNextGoodOneGoesOn) {
  const TypeParam largest = std::numeric_limits<TypeParam>::max();
  const TypeParam infinity = std::numeric_limits<TypeParam>::infinity();
  this->start(this->at(0));
  for (int tick = 1; tick <= 3000; ++tick) {
    ASSERT_EQ(this->tick(this->at(0.001 * tick)), Status::kOk);
  }
  auto undisturbed = this->state;
  const Bits before = bits_of(this->state);
  for (const TypeParam bad :
       {largest, -largest, infinity, std::numeric_limits<TypeParam>::quiet_NaN()}) {
    auto input = estimator_input<kJoints, TypeParam>(this->at(3.001));
    input.z.template segment<kJoints>(1 + kJoints).setConstant(bad);
    EXPECT_EQ(step(this->config, input, this->state), Status::kNumericOverflow) << bad;
    EXPECT_EQ(bits_of(this->state), before) << bad;
    input = estimator_input<kJoints, TypeParam>(this->at(3.001));
    input.nominal_rate.setConstant(std::fabs(bad) > largest || std::isnan(bad) ? bad : infinity);
    EXPECT_EQ(step(this->config, input, this->state), Status::kNumericOverflow) << bad;
    EXPECT_EQ(bits_of(this->state), before) << bad;
  }
  const auto good = estimator_input<kJoints, TypeParam>(this->at(3.001));
  EXPECT_EQ(step(this->config, good, this->state), Status::kOk);
  EXPECT_EQ(step(this->config, good, undisturbed), Status::kOk);
  EXPECT_EQ(bits_of(this->state), bits_of(undisturbed));
}

TYPED_TEST(Estimator, TheThresholdSettlesAtTheBoundOverThePole) {
  PlainSample still = this->at(0);
  still.nominal.setZero();
  still.mu_bar = 0.8;
  this->start(still);
  for (int tick = 1; tick <= 5000; ++tick) ASSERT_EQ(this->tick(still), Status::kOk);
  EXPECT_NEAR(static_cast<double>(this->state.mu), 0.8 / 10, 1e-5);
  EXPECT_LE(this->state.error.norm(), TypeParam(1e-5));
}

}  // namespace
}  // namespace offnominal::test
