#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <offnominal/diagnosis/network.hpp>

#include "core/diagnosis/estimator_run.hpp"
#include "core/model/random_chain.hpp"
#include "core/print_status.hpp"
#include "support/repetitions.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

template <typename Scalar>
Scalar sigmoid_of(Scalar x) {
  return sigmoid<1, Scalar>(Eigen::Array<Scalar, 1, 1>(x))[0];
}

TEST(Sigmoid, EqualsTheHyperbolicTangentOfHalfItsArgumentInDouble) {
  for (double x = -50; x <= 50; x += 0.001) {
    EXPECT_NEAR(sigmoid_of(x), std::tanh(x / 2), 1e-15) << x;
  }
}

TEST(Sigmoid, EqualsTheHyperbolicTangentOfHalfItsArgumentInFloat) {
  for (float x = -50; x <= 50; x += 0.001F) {
    const double exact = std::tanh(static_cast<double>(x) / 2);
    EXPECT_NEAR(static_cast<double>(sigmoid_of(x)), exact, 4e-7) << x;
  }
}

template <typename Scalar>
void expect_right_limits() {
  const Scalar infinity = std::numeric_limits<Scalar>::infinity();
  const Scalar largest = std::numeric_limits<Scalar>::max();
  const Scalar tolerance = 4 * std::numeric_limits<Scalar>::epsilon();
  for (const Scalar x : {Scalar(40), Scalar(800), largest, infinity}) {
    EXPECT_NEAR(sigmoid_of(x), Scalar(1), tolerance) << x;
    EXPECT_NEAR(sigmoid_of(-x), Scalar(-1), tolerance) << x;
  }
  EXPECT_EQ(sigmoid_of(Scalar(0)), Scalar(0));
  EXPECT_EQ(sigmoid_of(-Scalar(0)), Scalar(0));
}

TEST(Sigmoid, IsExactlyZeroAtZeroAndOneAtInfinity) {
  expect_right_limits<double>();
  expect_right_limits<float>();
}

TEST(Sigmoid, NeverLeavesMinusOneToOne) {
  std::mt19937_64 generator = seeded_generator();
  for (int sample = 0; sample < repetitions(100000); ++sample) {
    const double x =
        std::copysign(std::pow(10, uniform(generator, -30, 30)), uniform(generator, -1, 1));
    EXPECT_LE(std::fabs(sigmoid_of(x)), 1.0) << x;
    EXPECT_LE(std::fabs(sigmoid_of(static_cast<float>(x))), 1.0F) << x;
  }
}

// Every lane of a vector instruction gives what one number alone gives, to the same tolerance.
TEST(Sigmoid, WorksOnWholeVectors) {
  Eigen::Array<float, 16, 1> x;
  for (Eigen::Index i = 0; i < 16; ++i) x[i] = static_cast<float>(i) - 7.5F;
  const Eigen::Array<float, 16, 1> y = sigmoid(x);
  for (Eigen::Index i = 0; i < 16; ++i) {
    EXPECT_NEAR(y[i], std::tanh(x[i] / 2), 1e-6F);
  }
}

TEST(InitialWeights, AreReproducibleWithinTheirRangeAndTheSameForBothScalars) {
  const auto in_double = initial_weights<2, 35, double>(42, 35, 0.1);
  const auto again = initial_weights<2, 35, double>(42, 35, 0.1);
  const auto in_float = initial_weights<2, 35, float>(42, 35, 0.1F);
  const auto other_seed = initial_weights<2, 35, double>(43, 35, 0.1);
  EXPECT_EQ(in_double.w1, again.w1);
  EXPECT_NE(in_double.w1, other_seed.w1);
  EXPECT_LE(in_double.w1.cwiseAbs().maxCoeff(), 0.1);
  EXPECT_LE((in_double.w1 - in_float.w1.cast<double>()).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_TRUE(in_double.w2_transposed.isZero(0));
  EXPECT_TRUE(in_float.w2_transposed.isZero(0));
}

TEST(InitialWeights, AreSpreadEvenlyOverTheirRange) {
  const auto weights = initial_weights<6, 500, double>(1, 500, 1.0);
  const auto used = weights.w1.topRows<500>();
  const double count = static_cast<double>(used.size());
  EXPECT_NEAR(used.mean(), 0, 4 / std::sqrt(3 * count));
  EXPECT_NEAR(used.squaredNorm() / count, 1.0 / 3, 4 * 0.3 / std::sqrt(count));
  EXPECT_GT(used.maxCoeff(), 0.99);
  EXPECT_LT(used.minCoeff(), -0.99);
}

TEST(InitialWeights, LeaveUnitsThatAreNotInUseAtZero) {
  const auto weights = initial_weights<2, 16, float>(1, 5, 0.1F);
  EXPECT_FALSE(weights.w1.topRows<5>().isZero(0));
  EXPECT_TRUE(weights.w1.bottomRows(weights.w1.rows() - 5).isZero(0));
}

template <int N, int L>
NetworkWeights<N, L, double> random_weights(std::mt19937_64& generator) {
  NetworkWeights<N, L, double> weights;
  for (Eigen::Index unit = 0; unit < L; ++unit) {
    for (double& w : weights.w1.row(unit)) w = uniform(generator, -1, 1);
    for (double& w : weights.w2_transposed.row(unit)) w = uniform(generator, -1, 1);
  }
  return weights;
}

PlainEstimator plain_network(int joints, int hidden) {
  PlainEstimator plain;
  plain.joints = joints;
  plain.hidden = hidden;
  return plain;
}

template <int N, int L>
void expect_output_of_equation_4(std::mt19937_64& generator) {
  const PlainEstimator plain = plain_network(N, L);
  for (int sample = 0; sample < 100; ++sample) {
    const auto weights = random_weights<N, L>(generator);
    const auto q = random_vector<N, double>(generator, 3);
    const auto dq = random_vector<N, double>(generator, 3);
    const auto tau = random_vector<N, double>(generator, 3);
    const Eigen::VectorXd z = plain.network_input({q, dq, tau, {}, 0});
    const auto own_z = network_input<N, double>(q, dq, tau);
    EXPECT_EQ(z, own_z);
    const Eigen::VectorXd expected = plain.psi_hat(theta_of(weights, L), z);
    EXPECT_LE(deviation(network_output(weights, own_z), expected), 1e-13);
  }
}

TEST(Network, ItsOutputIsEquation4) {
  std::mt19937_64 generator = seeded_generator();
  expect_output_of_equation_4<1, 1>(generator);
  expect_output_of_equation_4<2, 35>(generator);
  expect_output_of_equation_4<6, 24>(generator);
}

TEST(Network, WithoutOutputWeightsGivesExactlyZero) {
  std::mt19937_64 generator = seeded_generator();
  auto weights = random_weights<2, 35>(generator);
  weights.w2_transposed.setZero();
  const auto z = network_input<2, double>({1e3, -2}, {3, 4}, {-1e6, 7});
  EXPECT_EQ(network_output(weights, z), Eigen::Vector2d::Zero().eval());
}

TEST(Network, ThePlainGradientAgreesWithFiniteDifferences) {
  std::mt19937_64 generator = seeded_generator();
  const PlainEstimator plain = plain_network(2, 5);
  const Eigen::VectorXd theta = theta_of(random_weights<2, 5>(generator), 5);
  const Eigen::VectorXd z = random_vector<7, double>(generator, 2);
  const Eigen::MatrixXd gradient = plain.gradient(theta, z);
  for (Eigen::Index i = 0; i < theta.size(); ++i) {
    const double h = 1e-6;
    const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(theta.size(), i);
    const Eigen::VectorXd slope =
        (plain.psi_hat(theta + step, z) - plain.psi_hat(theta - step, z)) / (2 * h);
    EXPECT_LE((gradient.col(i) - slope).cwiseAbs().maxCoeff(), 1e-9);
  }
}

// One very short tick moves theta by period * Gamma * Z^T D[e]: the gradient that the product uses
// against finite differences of its own network.
TEST(Network, TheProductLearnsAlongTheGradientOfItsOwnOutput) {
  std::mt19937_64 generator = seeded_generator();
  constexpr int kUnits = 5;
  EstimatorConfig<double> config;
  config.period_s = 1e-6;
  config.hidden_units = kUnits;
  config.dead_zone = DeadZone::kDiscontinuous;
  PlainSample sample{random_vector<2, double>(generator, 1), random_vector<2, double>(generator, 1),
                     random_vector<2, double>(generator, 1), Eigen::Vector2d::Zero(), 0.1};
  EstimatorState<2, kUnits, double> state;
  ASSERT_EQ(reset_at(config, sample, state), Status::kOk);
  const auto weights = random_weights<2, kUnits>(generator);
  set_weights(weights, state);
  const Eigen::Vector2d error(2, -1.5);
  state.omega -= error;
  ASSERT_EQ(step(config, estimator_input<2, double>(sample), state), Status::kOk);

  const auto z = to_input<2, double>(sample);
  const auto slope = [&](auto&& change) {
    const double h = 1e-6;
    auto plus = weights;
    auto minus = weights;
    change(plus, h);
    change(minus, -h);
    return error.dot(network_output(plus, z) - network_output(minus, z)) / (2 * h);
  };
  const double scale = config.period_s * config.learning_rate;
  for (Eigen::Index unit = 0; unit < kUnits; ++unit) {
    for (Eigen::Index input = 0; input < 7; ++input) {
      const double expected = slope([&](auto& w, double h) { w.w1(unit, input) += h; });
      const double moved = state.weights.w1(unit, input) - weights.w1(unit, input);
      EXPECT_NEAR(moved / scale, expected, 1e-4);
    }
    for (Eigen::Index joint = 0; joint < 2; ++joint) {
      const double expected = slope([&](auto& w, double h) { w.w2_transposed(unit, joint) += h; });
      const double moved =
          state.weights.w2_transposed(unit, joint) - weights.w2_transposed(unit, joint);
      EXPECT_NEAR(moved / scale, expected, 1e-4);
    }
  }
}

}  // namespace
}  // namespace offnominal::test
