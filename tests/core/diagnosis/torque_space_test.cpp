#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <offnominal/diagnosis/detectability.hpp>
#include <offnominal/diagnosis/detector.hpp>
#include <offnominal/diagnosis/estimator.hpp>

#include "core/diagnosis/estimator_run.hpp"
#include "core/model/random_chain.hpp"
#include "core/print_status.hpp"
#include "support/repetitions.hpp"
#include "support/seed.hpp"

// The properties of docs/theory.md of the form joint by joint.

namespace offnominal::test {
namespace {

constexpr int kWatched = 3;
constexpr int kUnits = 6;
constexpr double kWithin = 1 - 1e-9;  // at equality |e_i| = mu_i is decided by rounding
using Torques = Vector<kWatched, double>;

// A robot whose momentum follows what acts on it beside the model, held over a tick, so that the
// samples are exact: p' = unmodelled. Watched by the product's estimator, learning included.
class MomentumRobot {
 public:
  MomentumRobot(const EstimatorConfig<double>& config, const Torques& bound)
      : config_(config), bound_(bound) {
    config_.hidden_units = kUnits;
    EXPECT_EQ(validate<kUnits>(config_), Status::kOk);
    EXPECT_EQ(reset(config_, input(), state), Status::kOk);
  }

  void tick(const Torques& unmodelled) {
    p_ += config_.period_s * unmodelled;
    ASSERT_EQ(step(config_, input(), state), Status::kOk);
    ++ticks_;
    update(detectors, errors_of<kWatched, double>(state.error, state.mu, {}), kNoJoint, ticks_,
           config_.period_s * static_cast<double>(ticks_));
  }

  // Behind a gap in which the momentum came to `p`.
  void go_on_at(const Torques& p) {
    p_ = p;
    ASSERT_EQ(resume(input(), Torques(Torques::Zero()), state), Status::kOk);
  }
  [[nodiscard]] const Torques& momentum() const { return p_; }

  EstimatorState<kWatched, kUnits, double, TorqueSpace> state;
  JointDetectors<kWatched, double> detectors;

 private:
  EstimatorInput<kWatched, double, TorqueSpace> input() const {
    const Torques phase = 0.3 * Torques(std::sin(0.01 * static_cast<double>(ticks_)), 0.4, -0.2);
    return {network_input<kWatched, double>(phase, p_, bound_), Torques::Zero(), bound_, {p_}};
  }

  EstimatorConfig<double> config_;
  Torques bound_;
  Torques p_ = Torques::Zero();
  std::uint64_t ticks_ = 0;
};

EstimatorConfig<double> random_estimator(std::mt19937_64& generator) {
  EstimatorConfig<double> config;
  config.period_s = 0.002;
  config.alpha = uniform(generator, 2, 40);
  config.learning_rate = 20;
  return config;
}

Torques random_bound(std::mt19937_64& generator) {
  return {uniform(generator, 0.01, 0.1), uniform(generator, 0.5, 5), uniform(generator, 20, 90)};
}

// Torques that jump between values with |u_i| <= bound_i, each joint at its own times.
class JumpingTorques {
 public:
  JumpingTorques(std::mt19937_64& generator, const Torques& bound)
      : generator_(generator), bound_(bound) {}

  const Torques& next() {
    for (Eigen::Index i = 0; i < value_.size(); ++i) {
      if (uniform(generator_, 0, 1) > 0.05) continue;
      const bool extreme = uniform(generator_, 0, 1) < 0.5;
      const double share =
          extreme ? std::copysign(1, uniform(generator_, -1, 1)) : uniform(generator_, -1, 1);
      value_[i] = kWithin * share * bound_[i];
    }
    return value_;
  }

 private:
  std::mt19937_64& generator_;
  Torques bound_;
  Torques value_ = Torques::Zero();
};

TEST(TorqueSpace, RaisesNoAlarmInAThousandUncertaintiesWithinTheBoundOfEachJoint) {
  std::mt19937_64 generator = seeded_generator();
  for (int run = 0; run < repetitions(1000); ++run) {
    const Torques bound = random_bound(generator);
    MomentumRobot robot(random_estimator(generator), bound);
    JumpingTorques jumping(generator, bound);
    for (int tick = 0; tick < 250; ++tick) robot.tick(jumping.next());
    ASSERT_FALSE(robot.detectors.latched) << "run " << run;
    ASSERT_TRUE(robot.state.psi_hat.isZero(0));
  }
}

// p - (p - e) is not e to the bit.
TEST(TorqueSpace, GivenAGapThenRoundingTakesNoJointBeyondItsThreshold) {
  std::mt19937_64 generator = seeded_generator();
  MomentumRobot robot(random_estimator(generator), random_bound(generator));
  int moved = 0;
  for (int run = 0; run < repetitions(1000); ++run) {
    const Torques mu(uniform(generator, 0.1, 1), uniform(generator, 0.1, 1), 0.25);
    robot.state.mu = mu;
    robot.state.error = {mu[0], -mu[1], 0.5};
    robot.go_on_at(Torques::NullaryExpr([&] { return uniform(generator, -50, 50); }));
    const Torques begins_with = robot.momentum() - robot.state.omega;
    ASSERT_EQ(robot.state.error, begins_with);
    for (const Eigen::Index joint : {0, 1}) {
      moved += std::abs(begins_with[joint]) > mu[joint] ? 1 : 0;
      ASSERT_LE(std::abs(begins_with[joint]), robot.state.mu[joint]) << "joint " << joint;
      ASSERT_NEAR(robot.state.mu[joint], mu[joint], 1e-12);
    }
    ASSERT_EQ(robot.state.mu[2], 0.25) << "beyond before, and no threshold of its own for it";
  }
  EXPECT_GT(moved, repetitions(1000) / 10) << "rounding has to matter here";
}

TEST(TorqueSpace, SeesOnAJointWhatExceedsItsBoundAndNothingOnTheOthers) {
  std::mt19937_64 generator = seeded_generator();
  for (int run = 0; run < repetitions(200); ++run) {
    const Torques bound = random_bound(generator);
    MomentumRobot robot(random_estimator(generator), bound);
    JumpingTorques jumping(generator, bound);
    const Eigen::Index faulty = run % kWatched;
    for (int tick = 0; tick < 1000; ++tick) {
      Torques unmodelled = jumping.next();
      if (tick >= 100) unmodelled[faulty] += 2.5 * bound[faulty];
      robot.tick(unmodelled);
    }
    ASSERT_TRUE(robot.detectors.latched);
    EXPECT_EQ(robot.detectors.first_joint, faulty);
    EXPECT_GT(robot.detectors.detection_tick, 100U);
    for (Eigen::Index i = 0; i < kWatched; ++i) {
      EXPECT_EQ(robot.detectors.joints[static_cast<std::size_t>(i)].latched, i == faulty);
      EXPECT_EQ(robot.state.psi_hat[i] != 0, i == faulty) << "a joint within its bound learns";
    }
  }
}

// Inside a tick in which its bound rises, a joint's error may pass its threshold for a moment while
// another one learns.
TEST(TorqueSpace, DoesNotLearnOnAJointThatBeganItsTickWithinItsThreshold) {
  EstimatorConfig<double> config;
  config.hidden_units = kUnits;
  EstimatorState<kWatched, kUnits, double, TorqueSpace> state;
  const auto input = [](const Torques& p, double third_bound) {
    const Torques bound(1, 1, third_bound);
    return EstimatorInput<kWatched, double, TorqueSpace>{
        network_input<kWatched, double>({0.3, 0.2, 0.1}, p, bound), Torques::Zero(), bound, {p}};
  };
  ASSERT_EQ(reset(config, input(Torques::Zero(), 0.1), state), Status::kOk);
  Torques p = Torques::Zero();
  for (int tick = 0; tick < 50; ++tick) {
    const bool rises = tick == 49;
    p += config.period_s * Torques(20, 0, rises ? 40 : 0);
    ASSERT_EQ(step(config, input(p, rises ? 100 : 0.1), state), Status::kOk);
    ASSERT_LT(std::fabs(state.error[2]), state.mu[2]);
  }
  EXPECT_NE(state.psi_hat[0], 0);
  EXPECT_EQ(state.psi_hat[2], 0);
}

// Theorem 4.2 of one joint.
TEST(TorqueSpace, SeesEveryFaultWhoseFilteredSizeExceedsTwiceItsJointsThreshold) {
  std::mt19937_64 generator = seeded_generator();
  int guaranteed = 0;
  for (int run = 0; run < repetitions(100); ++run) {
    const Torques bound = random_bound(generator);
    EstimatorConfig<double> config = random_estimator(generator);
    config.learning_rate = 0;
    MomentumRobot robot(config, bound);
    MomentumRobot without_uncertainty(config, bound);  // its e is eta, the filtered fault
    JumpingTorques jumping(generator, bound);
    const Torques fault = random_vector<kWatched, double>(generator, 5).cwiseProduct(bound);
    for (int tick = 0; tick < 300; ++tick) {
      const Torques now = tick < 50 ? Torques(Torques::Zero()) : fault;
      without_uncertainty.tick(now);
      robot.tick(jumping.next() + now);
      for (Eigen::Index i = 0; i < kWatched; ++i) {
        const double eta = std::fabs(without_uncertainty.state.error[i]);
        if (!detection_guaranteed(eta, robot.state.mu[i])) continue;
        ++guaranteed;
        ASSERT_TRUE(robot.detectors.joints[static_cast<std::size_t>(i)].level);
      }
    }
  }
  EXPECT_GT(guaranteed, 100);
}

// The uncertainty of the faulty joint works against the fault with all that its bound allows.
TEST(TorqueSpace, AttainsTheDetectionTimeBoundOfEveryJointWithinOneTick) {
  std::mt19937_64 generator = seeded_generator();
  for (int run = 0; run < repetitions(120); ++run) {
    EstimatorConfig<double> config = random_estimator(generator);
    config.period_s = 0.001;
    config.learning_rate = 0;
    const Torques bound = random_bound(generator);
    const Eigen::Index faulty = run % kWatched;
    FaultClass fault;
    fault.alpha = config.alpha;
    fault.rho = std::numeric_limits<double>::infinity();
    fault.margin = uniform(generator, 1.1, 6);
    fault.fault_time_s = 0.2;
    double delay_s = 0;
    ASSERT_EQ(detection_delay_bound(fault, delay_s), Status::kOk);
    MomentumRobot robot(config, bound);
    for (int tick = 0; tick < 200 + static_cast<int>((delay_s + 0.01) / config.period_s); ++tick) {
      Torques unmodelled = Torques::Zero();
      unmodelled[faulty] = -kWithin * bound[faulty];
      if (tick >= 200) unmodelled[faulty] += 2 * fault.margin * bound[faulty];
      robot.tick(unmodelled);
    }
    ASSERT_TRUE(robot.detectors.latched);
    const double seen_s = robot.detectors.detection_time_s - fault.fault_time_s;
    EXPECT_LE(seen_s, delay_s + 1.01 * config.period_s);
    EXPECT_GT(seen_s, delay_s - 1.01 * config.period_s);
  }
}

TEST(TorqueSpace, NeverLeavesTheBallWhateverActs) {
  std::mt19937_64 generator = seeded_generator();
  for (int run = 0; run < repetitions(20); ++run) {
    EstimatorConfig<double> config = random_estimator(generator);
    config.learning_rate = 500;
    config.weight_radius = 2;
    config.dead_zone = run % 2 == 0 ? DeadZone::kContinuous : DeadZone::kDiscontinuous;
    MomentumRobot robot(config, random_bound(generator));
    double largest = 0;
    for (int tick = 0; tick < 300; ++tick) {
      robot.tick(random_vector<kWatched, double>(generator, 500));
      const double norm = weight_norm<kWatched, kUnits, double>(robot.state.weights);
      ASSERT_LE(norm, config.weight_radius);
      largest = std::max(largest, norm);
    }
    EXPECT_GT(largest, 0.99 * config.weight_radius) << "the ball was not reached";
  }
}

TEST(JointDeadZone, IsZeroWithinEachThresholdAndTakesItOffOutside) {
  const Torques e(3, -5, 0.5);
  const Torques mu(1, 2, 0.5);
  EXPECT_EQ((dead_zone<3, double>(e, mu, DeadZone::kContinuous)), Torques(2, -3, 0));
  EXPECT_EQ((dead_zone<3, double>(e, mu, DeadZone::kDiscontinuous)), Torques(3, -5, 0));
  EXPECT_NEAR((dead_zone<3, double>(e, mu, DeadZone::kContinuous, 0.1).norm()), 0.1, 1e-15);
  const Torques none = Torques::Zero();
  EXPECT_EQ((dead_zone<3, double>(none, none, DeadZone::kContinuous)), none);
}

using Three = Vector<3, float>;
Eigen::Index judge(JointDetectors<3, float>& detectors, const Three& e, const Three& mu,
                   Eigen::Index jumped, std::uint64_t tick) {
  return update<3, float>(detectors, errors_of<3, float>(e, mu, {}), jumped, tick,
                          0.001 * static_cast<double>(tick));
}

TEST(JointDetectors, SayOfJointsThatCrossTogetherTheOneThatIsFarthestBeyond) {
  JointDetectors<3, float> detectors;
  EXPECT_EQ(judge(detectors, Three(0, 0, 0), Three(0, 0, 0), kNoJoint, 0), 0);
  EXPECT_FALSE(detectors.level);
  EXPECT_EQ(judge(detectors, Three(1.5F, -6, 1), Three(1, 2, 1), kNoJoint, 4), 1);
  EXPECT_TRUE(detectors.latched && detectors.joints[0].latched && detectors.joints[1].latched);
  EXPECT_FALSE(detectors.joints[2].latched);
  EXPECT_EQ(detectors.first_joint, 1);
  EXPECT_EQ(judge(detectors, Three(0, 0, 9), Three(1, 2, 1), kNoJoint, 5), 2);
  EXPECT_EQ(detectors.first_joint, 1) << "the first one stays";
  EXPECT_FALSE(detectors.joints[1].level);
  EXPECT_EQ(detectors.joints[2].detection_tick, 5U);
  clear_latch(detectors);
  EXPECT_FALSE(detectors.latched || detectors.joints[0].latched);
}

TEST(JointDetectors, SayTheJointWhosePositionNoMotionBringsWhateverTheErrors) {
  JointDetectors<3, float> detectors;
  EXPECT_EQ(judge(detectors, Three(0.5F, 3, 0), Three(1, 2, 1), 2, 4), 1);
  EXPECT_TRUE(detectors.joints[1].latched && detectors.joints[2].latched);
  EXPECT_EQ(detectors.first_joint, 2);
  EXPECT_EQ(judge(detectors, Three(0, 0, 0), Three(1, 2, 1), kNoJoint, 5), 0);
  EXPECT_FALSE(detectors.level || detectors.joints[2].level);
  EXPECT_TRUE(detectors.latched);
}

TEST(JointDetectors, ActOnlyBeyondTheSecondLevelAndKeepIt) {
  PerJoint<3, JointBound<float>> bounds{};
  bounds[1].act_ratio = 2;
  JointDetectors<3, float> detectors;
  const Three mu(1, 1, 1);
  const auto take = [&](const Three& e, Eigen::Index jumped, std::uint64_t tick) {
    update<3, float>(detectors, errors_of<3, float>(e, mu, bounds), jumped, tick, 0.001);
  };
  take({0, 1.9F, 0}, kNoJoint, 1);
  EXPECT_TRUE(detectors.latched && detectors.joints[1].latched);
  EXPECT_FALSE(detectors.acts || detectors.joints[1].acts) << "noticed, no more";
  take({0, -2.1F, 0}, kNoJoint, 2);
  EXPECT_TRUE(detectors.acts && detectors.joints[1].acts);
  take({0, 0, 0}, kNoJoint, 3);
  EXPECT_TRUE(detectors.acts && detectors.joints[1].acts) << "latched";
  EXPECT_FALSE(detectors.joints[0].acts);
  clear_latch(detectors);
  EXPECT_FALSE(detectors.acts || detectors.joints[1].acts);
  take({0, 0, 0}, 1, 4);
  EXPECT_TRUE(detectors.joints[1].acts) << "a jump is no matter of size";
  take({1.1F, 0, 0}, kNoJoint, 5);
  EXPECT_TRUE(detectors.joints[0].acts) << "one level: both at once";
}

// Of a joint the filter that is nearer to its threshold, or farther beyond.
TEST(JointErrors, AreThoseOfTheFilterThatIsNearerToItsThreshold) {
  PerJoint<3, JointBound<float>> bounds{};
  for (JointBound<float>& bound : bounds) bound.act_ratio = 3;
  auto errors = errors_of<3, float>({0.5F, -2, 0}, {1, 1, 1}, bounds);
  add<3, float>(errors_of<3, float>({8, -3, 0}, {2, 2, 2}, bounds), errors);
  EXPECT_EQ(errors.size, Three(8, 2, 0));
  EXPECT_EQ(errors.threshold, Three(2, 1, 1));
  EXPECT_TRUE(errors.acts[0]);
  EXPECT_FALSE(errors.acts[1] || errors.acts[2]);
}

}  // namespace
}  // namespace offnominal::test
