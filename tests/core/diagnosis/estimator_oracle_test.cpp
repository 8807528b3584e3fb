#include <gtest/gtest.h>

#include <algorithm>
#include <offnominal/diagnosis/estimator.hpp>
#include <type_traits>

#include "core/diagnosis/estimator_run.hpp"
#include "core/print_status.hpp"

namespace offnominal::test {
namespace {

template <int Joints, int Capacity, int Hidden, DeadZone Zone>
struct Case {
  static constexpr int kJoints = Joints;
  static constexpr int kCapacity = Capacity;
  static constexpr int kHidden = Hidden;
  static constexpr DeadZone kZone = Zone;
};

template <typename Tested>
class EstimatorOracle : public testing::Test {};

using Cases = testing::Types<
#ifndef OFFNOMINAL_SANITIZE                     // the same code in other sizes
    Case<1, 35, 35, DeadZone::kContinuous>,     //
    Case<1, 35, 35, DeadZone::kDiscontinuous>,  //
    Case<6, 24, 24, DeadZone::kContinuous>,     //
    Case<6, 24, 24, DeadZone::kDiscontinuous>,  //
#endif
    Case<1, 1, 1, DeadZone::kContinuous>,       //
    Case<2, 35, 35, DeadZone::kContinuous>,     //
    Case<2, 35, 35, DeadZone::kDiscontinuous>,  //
    Case<2, 16, 5, DeadZone::kContinuous>,      //
    Case<6, 7, 7, DeadZone::kContinuous>>;
TYPED_TEST_SUITE(EstimatorOracle, Cases);

template <int N, int L>
PlainEstimator plain_twin(const EstimatorConfig<double>& config, const PlainSample& start,
                          const EstimatorState<N, L, double>& state) {
  PlainEstimator plain;
  plain.joints = N;
  plain.hidden = config.hidden_units;
  plain.period_s = config.period_s;
  plain.alpha = config.alpha;
  plain.gamma = config.learning_rate;
  // The product's own allowance for rounding, so that both decide alike: it shrinks to the ball of
  // M^2 (1 - 2 m) and takes M^2 (1 - 4 m) as on it.
  const double margin = detail::rounding_allowance<L, double>(1.0);
  plain.radius = config.weight_radius * std::sqrt(1 - 2 * margin);
  plain.continuous_dead_zone = config.dead_zone == DeadZone::kContinuous;
  plain.ball_slack = 2 * margin;
  plain.omega = start.dq;
  plain.theta = theta_of(state.weights, config.hidden_units);
  plain.last = start;
  return plain;
}

// What the run went through, so that agreement is not agreement about nothing.
struct Coverage {
  int healthy_ticks = 0;
  int inside_ticks = 0;  // adapting, inside the ball
  int on_ball_ticks = 0;
};

struct Worst {
  double omega = 0;
  double mu = 0;
  double theta = 0;
  double psi_hat = 0;
};

template <int N, int L>
void compare(const EstimatorState<N, L, double>& state, const PlainEstimator& plain, Worst& worst) {
  const auto keep = [](double& largest, double value) {
    largest = value <= largest ? largest : value;
  };
  const Eigen::VectorXd psi_hat = plain.psi_hat(plain.theta, plain.network_input(plain.last));
  keep(worst.omega, (state.omega - plain.omega).cwiseAbs().maxCoeff());
  keep(worst.mu, std::fabs(state.mu - plain.mu));
  keep(worst.theta, (theta_of(state.weights, plain.hidden) - plain.theta).cwiseAbs().maxCoeff());
  keep(worst.psi_hat, (state.psi_hat - psi_hat).cwiseAbs().maxCoeff());
}

TYPED_TEST(EstimatorOracle, GivenTwentySecondsWithAFaultThenItEqualsThePlainForm) {
  constexpr int kJoints = TypeParam::kJoints;
  constexpr int kCapacity = TypeParam::kCapacity;
  EstimatorConfig<double> config;
  config.hidden_units = TypeParam::kHidden;
  config.dead_zone = TypeParam::kZone;
  config.weight_radius = 2.5;
  ASSERT_EQ(validate<kCapacity>(config), Status::kOk);
  const ExampleMotion motion{kJoints};
  const PlainSample start = motion.sample(0);
  EstimatorState<kJoints, kCapacity, double> state;
  ASSERT_EQ(reset_at(config, start, state), Status::kOk);
  PlainEstimator plain = plain_twin(config, start, state);

  Worst worst;
  Coverage coverage;
  for (int tick = 1; tick <= 20000; ++tick) {
    const PlainSample now = motion.sample(tick * config.period_s);
    ASSERT_EQ(step(config, estimator_input<kJoints, double>(now), state), Status::kOk);
    plain.step(now);
    compare(state, plain, worst);
    const bool adapting = state.error.norm() > state.mu;
    const bool on_ball = plain.theta.norm() > config.weight_radius * (1 - 1e-9);
    ++(!adapting ? coverage.healthy_ticks
       : on_ball ? coverage.on_ball_ticks
                 : coverage.inside_ticks);
  }
  EXPECT_LE(worst.omega, 1e-9);
  EXPECT_LE(worst.mu, 1e-9);
  EXPECT_LE(worst.theta, 1e-9);
  EXPECT_LE(worst.psi_hat, 1e-9);
  EXPECT_GT(coverage.healthy_ticks, 500);
  EXPECT_GT(coverage.inside_ticks, 100);
  EXPECT_GT(coverage.on_ball_ticks, 100);
}

}  // namespace
}  // namespace offnominal::test
