#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <offnominal/diagnosis/estimator.hpp>
#include <vector>

#include "core/diagnosis/estimator_run.hpp"
#include "core/print_status.hpp"

namespace offnominal::test {
namespace {

constexpr int kJoints = 2;
constexpr int kHidden = 8;
using State = EstimatorState<kJoints, kHidden, double>;
using Weights = NetworkWeights<kJoints, kHidden, double>;

// Signals that are linear between knots, so that a tick of any length that divides the distance of
// the knots interpolates them exactly. The fault pushes the error outwards all the time.
class PiecewiseLinear {
 public:
  PiecewiseLinear(double knot_distance_s, int knots, double fault)
      : knot_distance_s_(knot_distance_s) {
    for (int knot = 0; knot <= knots; ++knot) {
      const double t = knot * knot_distance_s;
      PlainSample at;
      at.q = Eigen::Vector2d(0.3 * std::sin(t), 0.4 * std::cos(2 * t));
      at.dq = Eigen::Vector2d(0.3 * std::cos(t), -0.8 * std::sin(2 * t));
      at.tau = Eigen::Vector2d(std::sin(5 * t), 0.7 * std::cos(4 * t));
      at.nominal = Eigen::Vector2d(-0.3 * std::sin(t) - fault, -1.6 * std::cos(2 * t) - fault);
      at.mu_bar = 0.3 + 0.1 * std::sin(3 * t);
      knots_.push_back(at);
    }
  }

  PlainSample at(double t) const {
    const double place = t / knot_distance_s_;
    const auto index = std::min(static_cast<std::size_t>(place + 1e-9), knots_.size() - 2);
    return between(knots_[index], knots_[index + 1], place - static_cast<double>(index));
  }

 private:
  double knot_distance_s_;
  std::vector<PlainSample> knots_;
};

struct Run {
  Eigen::VectorXd end;  // omega, mu, theta
  int adapting_ticks = 0;
  int on_ball_ticks = 0;
  int ticks = 0;
};

Run run(EstimatorConfig<double> config, const PiecewiseLinear& signals, const Weights& weights,
        Eigen::Vector2d error, double duration_s, int ticks) {
  config.period_s = duration_s / ticks;
  EXPECT_EQ(validate<kHidden>(config), Status::kOk);
  State state;
  EXPECT_EQ(reset_at(config, signals.at(0), state), Status::kOk);
  set_weights(weights, state);
  state.omega -= error;
  Run result;
  for (int tick = 1; tick <= ticks; ++tick) {
    const PlainSample now = signals.at(tick * config.period_s);
    EXPECT_EQ(step(config, estimator_input<kJoints, double>(now), state), Status::kOk);
    result.adapting_ticks += state.error.norm() > state.mu ? 1 : 0;
    result.on_ball_ticks += weight_norm(state.weights) > config.weight_radius * (1 - 1e-6) ? 1 : 0;
  }
  result.ticks = ticks;
  const Eigen::VectorXd theta = theta_of(state.weights, kHidden);
  result.end.resize(kJoints + 1 + theta.size());
  result.end << state.omega, state.mu, theta;
  return result;
}

Weights trained_weights() {
  Weights weights = initial_weights<kJoints, kHidden, double>(7, kHidden, 0.4);
  for (int unit = 0; unit < kHidden; ++unit) {
    weights.w2_transposed.row(unit) << 0.4 * std::sin(3 * unit), 0.4 * std::cos(5 * unit);
  }
  return weights;
}

// Ratio of the changes that two successive halvings of the step make: 2^4 for order 4.
double halving_ratio(const std::array<Run, 3>& runs) {
  return (runs[0].end - runs[1].end).norm() / (runs[1].end - runs[2].end).norm();
}

constexpr double kKnotDistance = 0.005;

std::array<Run, 3> three_steps(const EstimatorConfig<double>& config, const Weights& weights,
                               double fault, int knots) {
  const PiecewiseLinear signals(kKnotDistance, knots, fault);
  // Outside of the dead-zone from the start.
  const Eigen::Vector2d error = std::copysign(1.0, fault) * Eigen::Vector2d(0.5, 0.4);
  const double duration = knots * kKnotDistance;
  return {run(config, signals, weights, error, duration, knots),
          run(config, signals, weights, error, duration, 2 * knots),
          run(config, signals, weights, error, duration, 4 * knots)};
}

class IntegratorOrder : public testing::TestWithParam<DeadZone> {};

TEST_P(IntegratorOrder, IsFourWhileLearningInsideTheBall) {
  EstimatorConfig<double> config;
  config.alpha = 3;
  config.hidden_units = kHidden;
  config.dead_zone = GetParam();
  config.weight_radius = 1000;
  const auto runs = three_steps(config, trained_weights(), 4, 80);
  EXPECT_EQ(runs[0].adapting_ticks, runs[0].ticks);
  EXPECT_EQ(runs[2].adapting_ticks, runs[2].ticks);
  EXPECT_GE(halving_ratio(runs), 14);
  EXPECT_LE(halving_ratio(runs), 18);
}

INSTANTIATE_TEST_SUITE_P(BothDeadZones, IntegratorOrder,
                         testing::Values(DeadZone::kContinuous, DeadZone::kDiscontinuous),
                         [](const testing::TestParamInfo<DeadZone>& tested) {
                           return tested.param == DeadZone::kContinuous ? "Continuous"
                                                                        : "Discontinuous";
                         });

TEST(IntegratorOrder, IsFourInTheFilterAlone) {
  EstimatorConfig<double> config;
  config.alpha = 3;
  config.hidden_units = kHidden;
  config.learning_rate = 0;
  const auto runs = three_steps(config, trained_weights(), 0, 80);
  EXPECT_GE(halving_ratio(runs), 14);
  EXPECT_LE(halving_ratio(runs), 18);
}

}  // namespace
}  // namespace offnominal::test
