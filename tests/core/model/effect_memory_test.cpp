#include <gtest/gtest.h>

#include <cmath>
#include <offnominal/model/effect_memory.hpp>
#include <vector>

#include "core/model/random_chain.hpp"
#include "core/print_status.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

constexpr double kPeriod = 0.001;

// Dahl's equation in small steps along the way, without its solution.
double integrated(double z, double travelled, double width) {
  constexpr int kSteps = 20000;
  const double step = travelled / kSteps;
  const double direction = travelled < 0 ? -1 : 1;
  for (int i = 0; i < kSteps; ++i) {
    const double half = z + 0.5 * step * (1 - z * direction) / width;
    z += step * (1 - half * direction) / width;
  }
  return z;
}

TEST(Hysteresis, FollowsDahlsEquation) {
  const std::array<double, kMaxEffectParameters> parameters{2.0, 0.03};
  double z = 0;
  double expected = 0;
  for (const double travelled : {0.01, 0.02, -0.005, 0.001, -0.2, 0.4}) {
    expected = integrated(expected, travelled, 0.03);
    z = effects::Hysteresis::next_state(parameters, z, travelled);
    EXPECT_NEAR(z, expected, 1e-7) << travelled;
    EXPECT_NEAR(effects::Hysteresis::torque_of_state(parameters, z), 2 * expected, 2e-7);
  }
}

TEST(Hysteresis, StaysWhereItIsAtRest) {
  const std::array<float, kMaxEffectParameters> parameters{2.0F, 0.03F};
  EXPECT_FLOAT_EQ(effects::Hysteresis::next_state(parameters, 0.3F, 0.0F), 0.3F);
}

class Remembering {
 public:
  explicit Remembering(const std::vector<Effect<double>>& effects) {
    for (const Effect<double>& effect : effects) EXPECT_TRUE(chain_.effects.add(effect));
    EXPECT_EQ(validate(chain_), Status::kOk);
    EXPECT_EQ(memory_.validate(chain_, kPeriod), Status::kOk);
    memory_.prepare(chain_, make_model(chain_), kPeriod);
  }

  void begin(const JointSample<2, double>& sample) {
    memory_.keep_begin(sample, memory_.begin(sample), state_);
  }
  void next(const JointSample<2, double>& sample, std::uint32_t missed = 0) {
    memory_.keep(sample, missed, memory_.next(sample, missed, state_), state_);
  }
  void next_torque(double first, double second, std::uint32_t missed = 0) {
    next({Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), {first, second}}, missed);
  }
  [[nodiscard]] const EffectMemory<2, double>::State& state() const { return state_; }

 private:
  Chain<2, double> chain_;
  EffectMemory<2, double> memory_;
  EffectMemory<2, double>::State state_;
};

TEST(EffectMemory, GivesTheTorqueThatWasLoggedBefore) {
  Remembering memory({{EffectKind::kTimeDelay, 1, {2.25 * kPeriod}}});
  memory.begin({Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), {5, 7}});
  EXPECT_EQ(memory.state().tau, Eigen::Vector2d(5, 7));
  std::vector<double> logged{7, 7, 7, 7};
  auto generator = seeded_generator();
  for (int tick = 0; tick < 1000; ++tick) {
    logged.push_back(uniform(generator, -9, 9));
    memory.next_torque(tick, logged.back());
    EXPECT_EQ(memory.state().tau[0], tick) << "without a delay";
    const std::size_t now = logged.size() - 1;
    ASSERT_NEAR(memory.state().tau[1], 0.75 * logged[now - 2] + 0.25 * logged[now - 3], 1e-12);
  }
}

TEST(EffectMemory, HoldsAsManyTicksAsItSays) {
  Remembering memory({{EffectKind::kTimeDelay, 0, {kMaxDelayTicks * kPeriod}}});
  memory.begin({});
  for (int tick = 1; tick <= 3 * kMaxDelayTicks; ++tick) {
    memory.next_torque(tick, 0);
    EXPECT_NEAR(memory.state().tau[0], std::max(0, tick - kMaxDelayTicks), 1e-9);
  }
}

TEST(EffectMemory, TakesASamplesTorqueForThatOfTheTicksMissedBeforeIt) {
  Remembering memory({{EffectKind::kTimeDelay, 0, {3 * kPeriod}}});
  memory.begin({});
  memory.next_torque(1, 0);
  memory.next_torque(2, 0, 1);  // a tick with 2 that nobody saw, and this one
  EXPECT_EQ(memory.state().tau[0], 0);
  memory.next_torque(3, 0);
  EXPECT_EQ(memory.state().tau[0], 1);
  memory.next_torque(4, 0);
  EXPECT_EQ(memory.state().tau[0], 2);
  memory.next_torque(5, 0, 1000);
  EXPECT_EQ(memory.state().tau[0], 5);
}

TEST(EffectMemory, AddsTheTorquesOfAllThatHasAStateAsTheDriveIsTold) {
  Remembering memory({{EffectKind::kHysteresis, 0, {2.0, 0.1}},
                      {EffectKind::kViscousFriction, 1, {1.0}},
                      {EffectKind::kHysteresis, 0, {0.5, 0.01}},
                      {EffectKind::kHysteresis, 1, {3.0, 0.2}},
                      {EffectKind::kTorqueScale, 1, {0.5}}});
  JointSample<2, double> sample;
  sample.q << 1, 1;
  memory.begin(sample);
  EXPECT_EQ(memory.state().remembered, Eigen::Vector2d::Zero());
  sample.q << 1.1, 0.9;
  memory.next(sample);
  const double e = std::exp(-1.0);
  EXPECT_NEAR(memory.state().remembered[0], 2 * (1 - e) + 0.5 * (1 - std::pow(e, 10)), 1e-12);
  EXPECT_NEAR(memory.state().remembered[1], -1.5 * 3 * (1 - std::sqrt(e)), 1e-12);
  sample.q << 0.9, 0.9;  // back: from the state that it had
  memory.next(sample);
  const double z = -1 + (1 - e + 1) * e * e;
  EXPECT_NEAR(memory.state().remembered[0], 2 * z + 0.5 * (-1 + 2 * std::exp(-20.0)), 1e-4);
}

TEST(EffectMemory, AChainThatNeedsItIsRefusedWithoutIt) {
  Chain<2, double> chain;
  EXPECT_EQ((NoEffectMemory<2, double>::validate(chain, kPeriod)), Status::kOk);
  ASSERT_TRUE(chain.effects.add({EffectKind::kHysteresis, 0, {1.0, 0.1}}));
  EXPECT_EQ((NoEffectMemory<2, double>::validate(chain, kPeriod)), Status::kNeedsMemory);
  EXPECT_TRUE(remembers(EffectKind::kTimeDelay));
  EXPECT_FALSE(remembers(EffectKind::kCoulombFriction));
}

TEST(EffectMemory, DelaysOfOneJointThatAreTooLongTogetherAreRefused) {
  Chain<2, double> chain;
  const double half = 0.5 * kMaxDelayTicks * kPeriod;
  ASSERT_TRUE(chain.effects.add({EffectKind::kTimeDelay, 0, {half}}));
  ASSERT_TRUE(chain.effects.add({EffectKind::kTimeDelay, 1, {half}}));
  EXPECT_EQ((EffectMemory<2, double>::validate(chain, kPeriod)), Status::kOk);
  ASSERT_TRUE(chain.effects.add({EffectKind::kTimeDelay, 1, {half + 1e-6}}));
  EXPECT_EQ((EffectMemory<2, double>::validate(chain, kPeriod)), Status::kInvalidEffect);
}

}  // namespace
}  // namespace offnominal::test
