#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <offnominal/diagnosis/detectability.hpp>
#include <offnominal/diagnosis/estimator.hpp>

#include "core/diagnosis/estimator_run.hpp"
#include "core/model/random_chain.hpp"
#include "core/print_status.hpp"
#include "support/repetitions.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// A robot of n joints without nominal acceleration: dq' = uncertainty + profile * fault, both of
// them held over a tick, so that the samples are exact. Watched by the product's estimator.
template <int N>
class WatchedRobot {
 public:
  WatchedRobot(double period_s, double alpha, double bound) : bound_(bound) {
    config_.period_s = period_s;
    config_.alpha = alpha;
    config_.hidden_units = 1;
    config_.learning_rate = 0;
    EXPECT_EQ(validate<1>(config_), Status::kOk);
    EXPECT_EQ(reset(config_, input(), state_), Status::kOk);
  }

  // True where |e| > mu at the tick's end.
  bool tick(const Vector<N, double>& acceleration) {
    dq_ += config_.period_s * acceleration;
    EXPECT_EQ(step(config_, input(), state_), Status::kOk);
    return state_.error.norm() > state_.mu;
  }
  double mu() const { return state_.mu; }
  double error() const { return state_.error.norm(); }

 private:
  EstimatorInput<N, double> input() const {
    const Vector<N, double> zero = Vector<N, double>::Zero();
    return {network_input<N, double>(zero, dq_, zero), zero, bound_};
  }

  EstimatorConfig<double> config_;
  EstimatorState<N, 1, double> state_;
  Vector<N, double> dq_ = Vector<N, double>::Zero();
  double bound_;
};

double profile(const FaultClass& fault, double since_fault_s) {
  return std::isinf(fault.rho) ? 1 : -std::expm1(-fault.rho * since_fault_s);
}

// Assumption 3.1 is strict; at equality |e| = mu is decided by rounding.
constexpr double kJustBelow = 1 - 1e-9;

// Seconds from the fault to the first tick that sees it. `uncertainty(t)` and `fault_at(t)` belong
// to the tick that begins at t; the profile is that of the tick's middle.
template <int N, typename Uncertainty, typename Fault>
double detection_delay(const FaultClass& fault, double bound, double period_s,
                       Uncertainty uncertainty, Fault fault_at, double give_up_s) {
  WatchedRobot<N> robot(period_s, fault.alpha, bound);
  const auto fault_tick = static_cast<int>(std::lround(fault.fault_time_s / period_s));
  for (int tick = 0;; ++tick) {
    const double t = tick * period_s;
    const double since_fault_s = (tick - fault_tick + 0.5) * period_s;
    Vector<N, double> acceleration = uncertainty(t);
    if (tick >= fault_tick) acceleration += profile(fault, since_fault_s) * fault_at(t);
    const bool seen = robot.tick(acceleration);
    EXPECT_FALSE(seen && tick < fault_tick) << "detected before the fault";
    if (seen || since_fault_s > give_up_s) return (tick + 1 - fault_tick) * period_s;
  }
}

// r [1 - (alpha e^{-rho s} - rho e^{-alpha s})/(alpha - rho)] - (1 - e^{-alpha (s+T)}), erratum 4.
double erratum_equation(const FaultClass& fault, double s) {
  const double a = fault.alpha;
  const double p = fault.rho;
  const double left = fault.margin * (1 - (a * std::exp(-p * s) - p * std::exp(-a * s)) / (a - p));
  return left - (1 - std::exp(-a * (s + fault.fault_time_s)));
}

FaultClass random_fault_class(std::mt19937_64& generator) {
  FaultClass fault;
  fault.alpha = uniform(generator, 2, 30);
  fault.rho = fault.alpha * uniform(generator, 0.05, 0.9);
  fault.margin = uniform(generator, 1.05, 6);
  fault.fault_time_s = uniform(generator, 0, 2);
  return fault;
}

TEST(DetectionDelayBound, IsTheRootOfTheCorrectedEquationAndTheClosedFormIsAbove) {
  std::mt19937_64 generator = seeded_generator();
  for (int sample = 0; sample < 2000; ++sample) {
    const FaultClass fault = random_fault_class(generator);
    double bound = 0;
    double closed_form = 0;
    ASSERT_EQ(detection_delay_bound(fault, bound), Status::kOk);
    ASSERT_EQ(detection_delay_closed_form(fault, closed_form), Status::kOk);
    EXPECT_LE(bound, closed_form);
    EXPECT_NEAR(erratum_equation(fault, bound), 0, 1e-12);
    EXPECT_GT(erratum_equation(fault, bound * (1 + 1e-6) + 1e-9), 0);
    EXPECT_LT(erratum_equation(fault, bound * (1 - 1e-3)), 0);
    EXPECT_NEAR(
        closed_form,
        std::log(fault.alpha * fault.margin / ((fault.alpha - fault.rho) * (fault.margin - 1))) /
            fault.rho,
        1e-12 * closed_form);
  }
}

TEST(DetectionDelayBound, OfAnAbruptFaultIsTheLimitOfFastOnesAndBelowItsClosedForm) {
  FaultClass fault;
  fault.rho = kInfinity;
  fault.fault_time_s = 50;
  double bound = 0;
  double closed_form = 0;
  ASSERT_EQ(detection_delay_bound(fault, bound), Status::kOk);
  ASSERT_EQ(detection_delay_closed_form(fault, closed_form), Status::kOk);
  EXPECT_NEAR(closed_form, std::log(2.0) / 10, 1e-15);
  EXPECT_NEAR(bound, closed_form, 1e-12) << "long after the start the two are one";
  fault.fault_time_s = 0.05;
  ASSERT_EQ(detection_delay_bound(fault, bound), Status::kOk);
  EXPECT_LT(bound, closed_form);
  const double left = fault.margin * -std::expm1(-fault.alpha * bound);
  EXPECT_NEAR(left, -std::expm1(-fault.alpha * (bound + 0.05)), 1e-12);
}

// The uncertainty works against the fault with all that its bound allows, always.
TEST(DetectionDelayBound, IsAttainedWithinOneTickByTheWorstCaseOfTheProof) {
  std::mt19937_64 generator = seeded_generator();
  const double period_s = 0.001;
  for (int sample = 0; sample < 200; ++sample) {
    FaultClass fault = random_fault_class(generator);
    if (sample % 4 == 0) fault.rho = kInfinity;
    fault.fault_time_s = std::round(fault.fault_time_s / period_s) * period_s;
    double bound = 0;
    ASSERT_EQ(detection_delay_bound(fault, bound), Status::kOk);
    const double k = uniform(generator, 0.5, 5);
    const Eigen::Vector2d direction = random_direction(generator).head<2>().normalized();
    const double delay = detection_delay<2>(
        fault, k, period_s, [&](double) { return (-kJustBelow * k * direction).eval(); },
        [&](double) { return (2 * fault.margin * k * direction).eval(); }, bound + 1);
    EXPECT_LE(delay, bound + 1.01 * period_s);
    EXPECT_GT(delay, bound - 1.01 * period_s);
  }
}

// Any uncertainty within the bound: its size and direction jump.
template <int N>
class JumpingVector {
 public:
  JumpingVector(std::mt19937_64& generator, double largest)
      : generator_(generator), largest_(largest) {}

  Vector<N, double> operator()(double t) {
    if (t >= next_jump_s_) {
      next_jump_s_ = t + uniform(generator_, 0.002, 0.3);
      std::normal_distribution<double> normal;
      for (double& x : value_) x = normal(generator_);
      value_ *= kJustBelow * largest_ * uniform(generator_, 0, 1) / value_.norm();
    }
    return value_;
  }

 private:
  std::mt19937_64& generator_;
  double largest_;
  double next_jump_s_ = 0;
  Vector<N, double> value_ = Vector<N, double>::Zero();
};

// A fault at least as large as the class demands, growing and shrinking above that.
double wandering_size(double t, double least, double swing) {
  return least * (1 + swing * (1 + std::sin(5 * t)));
}

template <int N>
void expect_never_later(std::mt19937_64& generator, int faults) {
  const double period_s = 0.002;
  for (int sample = 0; sample < faults; ++sample) {
    const FaultClass fault = random_fault_class(generator);
    double bound = 0;
    ASSERT_EQ(detection_delay_bound(fault, bound), Status::kOk);
    const double k = uniform(generator, 0.5, 5);
    const double swing = uniform(generator, 0, 0.5);
    const Vector<N, double> direction = random_vector<N, double>(generator, 1).normalized();
    // Half of them meet an uncertainty that fights the fault, the others any.
    JumpingVector<N> jumping(generator, k);
    const bool fights = uniform(generator, 0, 1) < 0.5;
    const double delay = detection_delay<N>(
        fault, k, period_s,
        [&](double t) -> Vector<N, double> {
          return fights ? Vector<N, double>(-kJustBelow * k * direction) : jumping(t);
        },
        [&](double t) -> Vector<N, double> {
          return wandering_size(t, 2 * fault.margin * k, swing) * direction;
        },
        bound + 1);
    EXPECT_LE(delay, bound + 1.5 * period_s) << "sample " << sample;
  }
}

TEST(DetectionDelayBound, IsNeverExceededInAThousandRandomFaultsOfItsClass) {
  std::mt19937_64 generator = seeded_generator();
  expect_never_later<1>(generator, repetitions(400));
  expect_never_later<2>(generator, repetitions(400));
  expect_never_later<6>(generator, repetitions(200));
}

// Constant component signs, turning direction: a positive vector that wanders between the axes.
TEST(DetectionDelayBound, GivenOnlyConstantSignsThenTheSmallerMarginIsNeverExceeded) {
  std::mt19937_64 generator = seeded_generator();
  const double period_s = 0.002;
  for (int sample = 0; sample < repetitions(300); ++sample) {
    FaultClass fault = random_fault_class(generator);
    fault.margin = uniform(generator, 1.5, 6);
    FaultClass reduced = fault;
    reduced.margin = margin_for_constant_signs(fault.margin, 2);
    double bound = 0;
    ASSERT_EQ(detection_delay_bound(reduced, bound), Status::kOk);
    const double k = uniform(generator, 0.5, 5);
    const double turning = uniform(generator, 1, 200);
    Eigen::Vector2d against = -kJustBelow * k * Eigen::Vector2d(1, 1).normalized();
    const double delay = detection_delay<2>(
        fault, k, period_s, [&](double) { return against; },
        [&](double t) {
          const double angle = std::numbers::pi / 4 * (1 + std::sin(turning * t));
          return (2 * fault.margin * k * Eigen::Vector2d(std::cos(angle), std::sin(angle))).eval();
        },
        bound + 1);
    EXPECT_LE(delay, bound + 1.5 * period_s) << "sample " << sample;
  }
}

// Why that smaller margin is needed: a fault that is now in one joint, now in the other.
TEST(DetectionDelayBound, GivenAFaultThatAlternatesBetweenJointsThenTheFullMarginWouldBeTooShort) {
  FaultClass fault;
  fault.margin = 1.3;
  fault.fault_time_s = 1;
  double bound = 0;
  ASSERT_EQ(detection_delay_bound(fault, bound), Status::kOk);
  const double delay = detection_delay<2>(
      fault, 1, 0.001,
      [](double) { return (-kJustBelow * Eigen::Vector2d(1, 1).normalized()).eval(); },
      [&](double t) -> Eigen::Vector2d {
        const bool first = std::fmod(t, 0.02) < 0.01;
        return 2 * fault.margin * (first ? Eigen::Vector2d(1, 0) : Eigen::Vector2d(0, 1));
      },
      bound + 5);
  EXPECT_GT(delay, bound + 1);
}

TEST(MarginForConstantSigns, IsTheMarginOverTheRootOfTheJoints) {
  EXPECT_EQ(margin_for_constant_signs(3, 1), 3);
  EXPECT_NEAR(margin_for_constant_signs(3, 2), 3 / std::numbers::sqrt2, 1e-15);
  EXPECT_NEAR(margin_for_constant_signs(3, 6), 3 / std::sqrt(6.0), 1e-15);
}

struct NoGuarantee {
  const char* name;
  FaultClass fault;
};

class WithoutGuarantee : public testing::TestWithParam<NoGuarantee> {};

TEST_P(WithoutGuarantee, ThereIsNoBoundAndTheDelayIsUntouched) {
  double delay = 123;
  EXPECT_EQ(detection_delay_bound(GetParam().fault, delay), Status::kNoGuarantee);
  EXPECT_EQ(detection_delay_closed_form(GetParam().fault, delay), Status::kNoGuarantee);
  EXPECT_EQ(delay, 123);
}

INSTANTIATE_TEST_SUITE_P(All, WithoutGuarantee,
                         testing::Values(NoGuarantee{"MarginOne", {10, 0.5, 1, 10}},
                                         NoGuarantee{"MarginBelowOne", {10, 0.5, 0.9, 10}},
                                         NoGuarantee{"AbruptMarginOne", {10, kInfinity, 1, 10}},
                                         NoGuarantee{"AlphaEqualsRho", {10, 10, 2, 10}},
                                         NoGuarantee{"AlphaBelowRho", {10, 11, 2, 10}},
                                         NoGuarantee{"AlphaZero", {0, 0.5, 2, 10}},
                                         NoGuarantee{"AlphaNegative", {-1, -2, 2, 10}},
                                         NoGuarantee{"AlphaInfinite", {kInfinity, 0.5, 2, 10}},
                                         NoGuarantee{"AlphaNaN", {kNaN, 0.5, 2, 10}},
                                         NoGuarantee{"RhoZero", {10, 0, 2, 10}},
                                         NoGuarantee{"RhoNegative", {10, -1, 2, 10}},
                                         NoGuarantee{"RhoMinusInfinite", {10, -kInfinity, 2, 10}},
                                         NoGuarantee{"RhoNaN", {10, kNaN, 2, 10}},
                                         NoGuarantee{"MarginInfinite", {10, 0.5, kInfinity, 10}},
                                         NoGuarantee{"MarginNaN", {10, 0.5, kNaN, 10}},
                                         NoGuarantee{"FaultTimeNegative", {10, 0.5, 2, -1}},
                                         NoGuarantee{"FaultTimeInfinite", {10, 0.5, 2, kInfinity}},
                                         NoGuarantee{"FaultTimeNaN", {10, 0.5, 2, kNaN}}),
                         [](const testing::TestParamInfo<NoGuarantee>& tested) {
                           return tested.param.name;
                         });

TEST(Sensitivity, IsGuaranteedOnlyAboveTwiceTheThreshold) {
  EXPECT_FALSE(detection_guaranteed(0.0, 0.0));
  EXPECT_FALSE(detection_guaranteed(2.0, 1.0));
  EXPECT_TRUE(detection_guaranteed(2.0001, 1.0));
  EXPECT_FALSE(detection_guaranteed(1.0F, 0.6F));
  EXPECT_FALSE(detection_guaranteed(kNaN, 1.0));
  EXPECT_FALSE(detection_guaranteed(1.0, kNaN));
}

// Theorem 4.2 on random faults of any shape: wherever the filtered fault is above 2 mu, |e| > mu.
TEST(Sensitivity, WhereItIsGuaranteedTheErrorIsOutsideTheThreshold) {
  std::mt19937_64 generator = seeded_generator();
  const double period_s = 0.001;
  const double alpha = 8;
  int guaranteed = 0;
  int seen_without = 0;
  for (int sample = 0; sample < 100; ++sample) {
    const double k = uniform(generator, 0.5, 3);
    WatchedRobot<2> robot(period_s, alpha, k);
    JumpingVector<2> uncertainty(generator, k);
    JumpingVector<2> fault(generator, uniform(generator, 1, 8) * k);
    Eigen::Vector2d eta = Eigen::Vector2d::Zero();
    for (int tick = 0; tick < 3000; ++tick) {
      const double t = tick * period_s;
      const Eigen::Vector2d beta_psi = tick < 500 ? Eigen::Vector2d::Zero().eval() : fault(t);
      const bool seen = robot.tick(uncertainty(t) + beta_psi);
      // The exact filter of a signal that is held over the tick.
      const double decay = std::exp(-alpha * period_s);
      eta = decay * eta + (1 - decay) / alpha * beta_psi;
      if (detection_guaranteed(eta.norm(), robot.mu() * (1 + 1e-9))) {
        ASSERT_TRUE(seen) << "sample " << sample << ", tick " << tick;
        ++guaranteed;
      } else if (seen) {
        ++seen_without;
      }
    }
  }
  EXPECT_GT(guaranteed, 1000);
  EXPECT_GT(seen_without, 1000) << "the condition is sufficient, not necessary";
}

}  // namespace
}  // namespace offnominal::test
