#include "offnominal/sim/two_link_plant.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "support/seed.hpp"

namespace offnominal::sim {
namespace {

using Eigen::Vector2d;

TwoLinkState random_state(std::mt19937_64& generator) {
  std::uniform_real_distribution<double> angle(-1.0, 1.0), speed(-2.0, 2.0);
  return {{angle(generator), angle(generator)}, {speed(generator), speed(generator)}};
}

TEST(TwoLinkPlant, EnergyIsConservedWithoutFriction) {
  const TwoLinkParameters arm;
  const TwoLinkPlant plant(arm, {}, no_uncertainty());
  TwoLinkState state{{0.4, -0.7}, {0.5, -1.0}};
  const auto energy = [&] { return kinetic_energy(arm, state) + potential_energy(arm, state.q); };
  const double start = energy();
  double largest_kinetic = 0.0;
  for (int k = 0; k < 10000; ++k) {
    state = plant.step(k * 1e-3, state, Vector2d::Zero(), 1e-3, 4);
    largest_kinetic = std::max(largest_kinetic, kinetic_energy(arm, state));
  }
  ASSERT_GT(largest_kinetic, 10.0) << "the arm must have moved";
  EXPECT_LT(std::abs(energy() - start), 1e-8 * largest_kinetic);
}

TEST(TwoLinkPlant, FrictionTakesEnergy) {
  const TwoLinkParameters arm;
  const TwoLinkPlant plant(
      arm, {}, [](double, const TwoLinkState& s) -> Vector2d { return paper_friction(s.dq); });
  TwoLinkState state{{0.4, -0.7}, {0.5, -1.0}};
  double last = kinetic_energy(arm, state) + potential_energy(arm, state.q);
  for (int k = 0; k < 2000; ++k) {
    state = plant.step(k * 1e-3, state, Vector2d::Zero(), 1e-3);
    const double energy = kinetic_energy(arm, state) + potential_energy(arm, state.q);
    EXPECT_LT(energy, last + 1e-12) << "tick " << k;
    last = energy;
  }
}

// The paper prints this norm of the uncertainty over its domain (two brackets lost in print).
TEST(TwoLinkPlant, UncertaintyHasThePaperNorm) {
  auto generator = test::seeded_generator();
  const TwoLinkPlant plant({}, {}, paper_uncertainty());
  std::uniform_real_distribution<double> time(0.0, 20.0);
  for (int i = 0; i < 200; ++i) {
    const TwoLinkState s = random_state(generator);
    const double t = time(generator), c = std::cos(s.q[1]), noise = std::sin(30.0 * t);
    const double f1 = std::copysign(1.0, s.dq[0]) + 4.0 * s.dq[0] + noise;
    const double f2 = std::sin(s.dq[1]) + 4.0 * s.dq[1] + noise;
    const double first = (1.0 + c) * f2 - f1;
    const double second = (1.0 + c) * f1 - (4.5 + 4.0 * c) * 0.5 * f2;
    const double printed = std::hypot(first, second) / std::abs(4.0 * c * c - 5.0);
    EXPECT_NEAR(plant.uncertainty_acceleration(t, s).norm(), printed, 1e-11 * (1.0 + printed));
  }
}

class FaultFunction : public testing::TestWithParam<FaultKind> {};

TEST_P(FaultFunction, IsTheDifferenceOfTheFaultyAndTheHealthyPlant) {
  auto generator = test::seeded_generator();
  Fault fault;
  fault.kind = GetParam();
  const TwoLinkPlant faulty({}, fault, paper_uncertainty());
  const TwoLinkPlant healthy({}, {}, paper_uncertainty());
  std::uniform_real_distribution<double> time(0.0, 20.0), torque(-40.0, 40.0);
  for (int i = 0; i < 500; ++i) {
    const TwoLinkState s = random_state(generator);
    const double t = time(generator);
    const Vector2d tau(torque(generator), torque(generator));
    const Vector2d psi = faulty.fault_function(t, s, tau);
    const Vector2d difference = faulty.acceleration(t, s, tau) - healthy.acceleration(t, s, tau);
    if (t <= fault.time_s) {
      EXPECT_EQ(psi, Vector2d::Zero()) << "t " << t;
      EXPECT_EQ(difference, Vector2d::Zero()) << "t " << t;
    } else {
      EXPECT_GT(psi.norm(), 0.0) << "t " << t;
      EXPECT_LT((psi - difference).norm(), 1e-11 * (1.0 + tau.norm())) << "t " << t;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, FaultFunction,
                         testing::Values(FaultKind::kMassLoss, FaultKind::kNonlinear));

TEST(TwoLinkPlant, MassLossChangesInertiaCoriolisAndGravityAsALighterArmWould) {
  auto generator = test::seeded_generator();
  Fault fault;
  fault.kind = FaultKind::kMassLoss;
  fault.rate_per_s = kAbrupt;
  const TwoLinkPlant faulty({}, fault, paper_uncertainty());
  TwoLinkParameters lighter;
  lighter.mass1_kg = 0.125;
  const TwoLinkPlant light(lighter, {}, paper_uncertainty());
  for (int i = 0; i < 50; ++i) {
    const TwoLinkState s = random_state(generator);
    EXPECT_EQ(faulty.acceleration(10.0, s, {30.0, 10.0}),
              light.acceleration(10.0, s, {30.0, 10.0}));
  }
}

TEST(TwoLinkPlant, TorqueIsHeldOverTheStep) {
  const TwoLinkPlant plant({}, {}, paper_uncertainty());
  const TwoLinkState start{{0.1, 0.2}, {0.4, -0.3}};
  const TwoLinkState once = plant.step(1.0, start, {30.0, 12.0}, 0.01, 10);
  TwoLinkState stepwise = start;
  for (int i = 0; i < 10; ++i) {
    stepwise = plant.step(1.0 + i * 0.001, stepwise, {30.0, 12.0}, 0.001);
  }
  EXPECT_LT((once.q - stepwise.q).norm(), 1e-14);
  EXPECT_LT((once.dq - stepwise.dq).norm(), 1e-13);
}

TEST(TwoLinkPlant, RefusesWhatIsNotAPlant) {
  const auto make = [](auto change) {
    TwoLinkParameters arm;
    change(arm);
    return TwoLinkPlant(arm, {}, no_uncertainty());
  };
  EXPECT_THROW(make([](auto& a) { a.mass1_kg = 0.0; }), std::invalid_argument);
  EXPECT_THROW(make([](auto& a) { a.mass2_kg = -1.0; }), std::invalid_argument);
  EXPECT_THROW(make([](auto& a) { a.length1_m = std::nan(""); }), std::invalid_argument);
  EXPECT_THROW(make([](auto& a) { a.gravity_m_s2 = std::numeric_limits<double>::infinity(); }),
               std::invalid_argument);
  EXPECT_THROW(TwoLinkPlant({}, {}, nullptr), std::invalid_argument);
  const TwoLinkPlant plant({}, {}, no_uncertainty());
  EXPECT_THROW(static_cast<void>(plant.step(0.0, {}, {}, 0.0)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(plant.step(0.0, {}, {}, 0.001, 0)), std::invalid_argument);
}

}  // namespace
}  // namespace offnominal::sim
