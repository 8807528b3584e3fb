// The corrected detection-time bound (core/diagnosis/detectability.hpp) against the filter of the
// theorem and against the estimator itself: the worst case of the proof attains it within a tick,
// no fault of its class exceeds it.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <offnominal/diagnosis/detectability.hpp>
#include <offnominal/diagnosis/estimator.hpp>
#include <random>

#include "support/repetitions.hpp"
#include "support/seed.hpp"

namespace offnominal {
namespace {

using Vector2 = Vector<2, double>;

constexpr double kPeriod = 1e-3;
// A detection is told at the end of its tick; the samples' own error moves it by a few
// microseconds.
constexpr double kOneTick = 1.02 * kPeriod;
constexpr double kBound = 1.7;  // K of the corollary, rad/s^2

// Integral of the time profile over [a, b], both measured from the fault; zero before it.
double profile_integral(double rho, double a, double b) {
  a = std::max(a, 0.0);
  b = std::max(b, 0.0);
  if (std::isinf(rho)) return b - a;
  return (b - a) + (std::exp(-rho * b) - std::exp(-rho * a)) / rho;
}

// e and mu of the theorem: the filter 1/(s + alpha) on uncertainty and fault, and on the bound.
class TheoremFilter {
 public:
  explicit TheoremFilter(double alpha) : alpha_(alpha) {}

  // `velocity` is what uncertainty and fault add to the velocity over one tick.
  bool step(const Vector2& velocity) {
    const double decay = std::exp(-alpha_ * kPeriod);
    const double gain = -std::expm1(-alpha_ * kPeriod) / alpha_;
    e_ = decay * e_ + gain * (velocity / kPeriod);
    mu_ = decay * mu_ + gain * kBound;
    return e_.norm() > mu_;
  }

 private:
  double alpha_;
  Vector2 e_ = Vector2::Zero();
  double mu_ = 0.0;
};

// The estimator on a plant whose nominal acceleration is zero.
class TheoremEstimator {
 public:
  explicit TheoremEstimator(double alpha) {
    config_.alpha = alpha;
    config_.period_s = kPeriod;
    config_.hidden_units = 4;
    const auto z = network_input<2, double>(Vector2::Zero(), Vector2::Zero(), Vector2::Zero());
    const EstimatorInput<2, double> at_rest{z, Vector2::Zero(), kBound};
    EXPECT_EQ(reset(config_, at_rest, state_), Status::kOk);
  }

  bool step(const Vector2& velocity) {
    dq_ += velocity;
    const auto z = network_input<2, double>(Vector2::Zero(), dq_, Vector2::Zero());
    const EstimatorInput<2, double> input{z, Vector2::Zero(), kBound};
    EXPECT_EQ(offnominal::step(config_, input, state_), Status::kOk);
    return state_.error.norm() > state_.mu;
  }

 private:
  EstimatorConfig<double> config_;
  EstimatorState<2, 4, double> state_;
  Vector2 dq_ = Vector2::Zero();
};

// Time from the fault to the detection, -1 for an alarm before it. `velocity(k)` gives what
// uncertainty and fault add over tick k, which begins at k kPeriod.
template <typename Detector, typename Velocity>
double detection_delay(Detector detector, double fault_time_s, double longest_s,
                       Velocity&& velocity) {
  const auto ticks = static_cast<int>(std::ceil((fault_time_s + longest_s) / kPeriod)) + 10;
  for (int k = 0; k < ticks; ++k) {
    if (!detector.step(velocity(k))) continue;
    const double delay = (k + 1) * kPeriod - fault_time_s;
    return delay > 0.0 ? delay : -1.0;
  }
  return std::numeric_limits<double>::infinity();
}

// Uncertainty at its bound against a fault of the smallest size in its class.
template <typename Detector>
double worst_case_delay(const FaultClass& fault, double longest_s) {
  const Vector2 direction(0.8, -0.6);
  // A hair inside the bound, so that rounding raises no alarm before the fault.
  const double uncertainty = -(1.0 - 1e-7) * kBound;
  return detection_delay(
      Detector(fault.alpha), fault.fault_time_s, longest_s, [&](int k) -> Vector2 {
        const double begin = k * kPeriod - fault.fault_time_s;
        const double profile = profile_integral(fault.rho, begin, begin + kPeriod);
        return (uncertainty * kPeriod + 2.0 * fault.margin * kBound * profile) * direction;
      });
}

FaultClass random_class(std::mt19937_64& generator) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  FaultClass fault;
  fault.alpha = 2.0 + 18.0 * unit(generator);
  fault.rho = unit(generator) < 0.2 ? std::numeric_limits<double>::infinity()
                                    : 0.3 + 0.6 * fault.alpha * unit(generator);
  fault.margin = 1.2 + 3.0 * unit(generator);
  // On a tick: between two ticks an abrupt fault begins as one that evolves.
  fault.fault_time_s = kPeriod * std::floor(1500.0 * unit(generator));
  return fault;
}

template <typename Detector>
void expect_attained() {
  auto generator = test::seeded_generator();
  for (int i = 0; i < test::repetitions(200); ++i) {
    const FaultClass fault = random_class(generator);
    double bound = 0.0, closed = 0.0;
    ASSERT_EQ(detection_delay_bound(fault, bound), Status::kOk);
    ASSERT_EQ(detection_delay_closed_form(fault, closed), Status::kOk);
    EXPECT_LE(bound, closed) << "class " << i;
    const double delay = worst_case_delay<Detector>(fault, bound);
    EXPECT_GE(delay, bound - kOneTick) << "class " << i << ", alpha " << fault.alpha << ", rho "
                                       << fault.rho << ", r " << fault.margin;
    EXPECT_LE(delay, bound + kOneTick) << "class " << i << ", alpha " << fault.alpha << ", rho "
                                       << fault.rho << ", r " << fault.margin;
  }
}

TEST(DetectionDelay, WorstCaseAttainsTheBoundInTheTheoremFilter) {
  expect_attained<TheoremFilter>();
}

TEST(DetectionDelay, WorstCaseAttainsTheBoundInTheEstimator) {
  expect_attained<TheoremEstimator>();
}

// Size and direction that change from tick to tick, each within its limits.
struct RandomSignals {
  std::mt19937_64 generator;
  double hold_s = 0.1;
  int next_change = 0;
  double size = 0.0, angle = 0.0;

  void advance(int tick) {
    if (tick < next_change) return;
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    size = std::pow(unit(generator), 0.3);
    angle = 2.0 * std::numbers::pi * unit(generator);
    next_change = tick + 1 + static_cast<int>(hold_s * unit(generator) / kPeriod);
  }
};

enum class Direction { kConstant, kConstantSigns };

template <typename Detector>
double random_delay(std::mt19937_64& generator, const FaultClass& fault, Direction kind,
                    double longest_s) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  RandomSignals uncertainty{std::mt19937_64(generator()), 0.5 * unit(generator)};
  RandomSignals psi{std::mt19937_64(generator()), 0.5 * unit(generator)};
  const double fixed_angle = 2.0 * std::numbers::pi * unit(generator);
  const double against = unit(generator) < 0.5 ? 1.0 : 0.0;
  return detection_delay(
      Detector(fault.alpha), fault.fault_time_s, longest_s, [&](int k) -> Vector2 {
        uncertainty.advance(k);
        psi.advance(k);
        // Half of the runs have the uncertainty work against the fault's direction.
        const double angle = against > 0.0 ? fixed_angle + std::numbers::pi : uncertainty.angle;
        const double strength = (1.0 - 1e-7) * kBound * uncertainty.size * kPeriod;
        const double fault_angle =
            kind == Direction::kConstant
                ? fixed_angle
                : 0.5 * std::numbers::pi * (psi.angle / (2.0 * std::numbers::pi));
        const double begin = k * kPeriod - fault.fault_time_s;
        const double push = 2.0 * fault.margin * kBound * (1.0 + 0.5 * psi.size * against) *
                            profile_integral(fault.rho, begin, begin + kPeriod);
        return strength * Vector2(std::cos(angle), std::sin(angle)) +
               push * Vector2(std::cos(fault_angle), std::sin(fault_angle));
      });
}

template <typename Detector>
void expect_never_exceeded(Direction kind) {
  auto generator = test::seeded_generator();
  for (int i = 0; i < test::repetitions(1000); ++i) {
    FaultClass fault = random_class(generator);
    FaultClass guaranteed = fault;
    if (kind == Direction::kConstantSigns) {
      fault.margin *= std::numbers::sqrt2;
      guaranteed.margin = margin_for_constant_signs(fault.margin, 2);
    }
    double bound = 0.0;
    ASSERT_EQ(detection_delay_bound(guaranteed, bound), Status::kOk);
    const double delay = random_delay<Detector>(generator, fault, kind, bound);
    ASSERT_GT(delay, 0.0) << "alarm before the fault, fault " << i;
    ASSERT_LE(delay, bound + kOneTick) << "fault " << i << ", alpha " << fault.alpha << ", rho "
                                       << fault.rho << ", r " << fault.margin;
  }
}

TEST(DetectionDelay, NoRandomFaultExceedsTheBoundInTheTheoremFilter) {
  expect_never_exceeded<TheoremFilter>(Direction::kConstant);
}

TEST(DetectionDelay, NoRandomFaultExceedsTheBoundInTheEstimator) {
  expect_never_exceeded<TheoremEstimator>(Direction::kConstant);
}

TEST(DetectionDelay, NoRandomFaultOfConstantSignsExceedsItsBound) {
  expect_never_exceeded<TheoremFilter>(Direction::kConstantSigns);
}

// Erratum 4: the printed bound (17) is smaller than T, so that every fault would contradict it.
TEST(DetectionDelay, PrintedBoundIsContradictedByTheWorstCase) {
  const FaultClass fault{.alpha = 10.0, .rho = 0.5, .margin = 2.0, .fault_time_s = 1.0};
  const double printed =
      std::log((fault.rho * std::exp(fault.alpha * fault.fault_time_s) + fault.alpha - fault.rho) /
               (fault.alpha * std::exp(fault.rho * fault.fault_time_s))) /
      (fault.alpha - fault.rho);
  EXPECT_LT(printed, fault.fault_time_s);
  EXPECT_GT(worst_case_delay<TheoremFilter>(fault, 10.0), 0.0);
}

}  // namespace
}  // namespace offnominal
