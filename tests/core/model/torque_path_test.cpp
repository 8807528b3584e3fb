#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <offnominal/control/computed_torque.hpp>
#include <offnominal/model/forward_dynamics.hpp>

#include "core/model/random_chain.hpp"
#include "core/model/two_link_closed_form.hpp"
#include "core/print_status.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

// Every joint with rotor, friction of the motor, friction by the load and a wrong torque constant.
template <int N, typename Scalar>
Chain<N, Scalar> chain_with_path(std::mt19937_64& generator) {
  Chain<N, Scalar> chain = random_chain<N, Scalar>(generator);
  for (int i = 0; i < N; ++i) {
    const auto joint = static_cast<std::uint8_t>(i);
    const auto add = [&](EffectKind kind, double first, double second) {
      EXPECT_TRUE(chain.effects.add(
          {kind, joint, {static_cast<Scalar>(first), static_cast<Scalar>(second)}}));
    };
    add(EffectKind::kRotorInertia, uniform(generator, 0.01, 0.3), 0);
    add(EffectKind::kCoulombFriction, uniform(generator, 0, 2), 0.1);
    add(EffectKind::kLoadDependentFriction, uniform(generator, 0, 0.3), 0.05);
    EXPECT_TRUE(chain.effects.add(
        {EffectKind::kGearLoss,
         joint,
         {static_cast<Scalar>(uniform(generator, 0, 0.55)),
          static_cast<Scalar>(uniform(generator, 0, 1.2)), static_cast<Scalar>(0.1)}}));
    add(EffectKind::kLoadDependentFriction, uniform(generator, 0, 0.05), 0.4);
    add(EffectKind::kTorqueScale, uniform(generator, -0.4, 0.4), 0);
    add(EffectKind::kTorqueScale, uniform(generator, -0.4, 0.4), 0);
  }
  EXPECT_EQ(validate(chain), Status::kOk);
  return chain;
}

struct RoundTrip {
  double torque = 0;        // tau -> ddq -> tau
  double acceleration = 0;  // ddq -> tau -> ddq
};

template <int N, typename Scalar>
RoundTrip worst_round_trip(std::mt19937_64& generator) {
  RoundTrip worst;
  for (int sample = 0; sample < 300; ++sample) {
    const auto model = make_model(chain_with_path<N, Scalar>(generator));
    EXPECT_TRUE(model.has_torque_path);
    const auto q = random_vector<N, Scalar>(generator, std::numbers::pi);
    const auto dq = random_vector<N, Scalar>(generator, sample % 2 == 0 ? 2.0 : 0.1);
    const auto tau = random_vector<N, Scalar>(generator, 50.0);
    ForwardDynamics<N, Scalar> forward;
    EXPECT_EQ(forward_dynamics(model, q, dq, tau, 1.0, forward), Status::kOk);
    const auto back = inverse_dynamics(model, q, dq, forward.ddq, 1.0);
    worst.torque = std::max(worst.torque, deviation(back, tau));
    const auto ddq = random_vector<N, Scalar>(generator, 20.0);
    const auto needed = inverse_dynamics(model, q, dq, ddq, 1.0);
    EXPECT_EQ(forward_dynamics(model, q, dq, needed, 1.0, forward), Status::kOk);
    worst.acceleration = std::max(worst.acceleration, deviation(forward.ddq, ddq));
  }
  return worst;
}

TEST(TorquePath, ForwardAndInverseDynamicsAreEachOthersInverse) {
  std::mt19937_64 generator = seeded_generator();
  const auto expect_below = [](const RoundTrip& worst, double torque, double acceleration) {
    EXPECT_LE(worst.torque, torque);
    EXPECT_LE(worst.acceleration, acceleration);
  };
  expect_below(worst_round_trip<1, double>(generator), 1e-10, 1e-9);
  expect_below(worst_round_trip<2, double>(generator), 1e-10, 1e-9);
  expect_below(worst_round_trip<6, double>(generator), 1e-9, 1e-8);
  // The acceleration in float is as good as the mass matrix' condition lets it be.
  expect_below(worst_round_trip<2, float>(generator), 5e-3, 0.5);
}

// The two-link arm in closed form, the path by its definition in the C library's own functions.
TEST(TorquePath, IsItsDefinitionOnAnArmInClosedForm) {
  std::mt19937_64 generator = seeded_generator();
  const TwoLinkClosedForm arm;
  Chain<2, double> chain;
  chain.gravity_m_s2 = {0, -arm.gravity, 0};
  chain.joints[0].mass_kg = arm.mass1;
  chain.joints[0].centre_of_mass_m = {arm.length1, 0, 0};
  chain.joints[1].origin_m = {arm.length1, 0, 0};
  chain.joints[1].mass_kg = arm.mass2;
  chain.joints[1].centre_of_mass_m = {arm.length2, 0, 0};
  ASSERT_TRUE(chain.effects.add({EffectKind::kLoadDependentFriction, 0, {0.3, 0.2}}));
  ASSERT_TRUE(chain.effects.add({EffectKind::kTorqueScale, 0, {0.25}}));
  ASSERT_TRUE(chain.effects.add({EffectKind::kViscousFriction, 0, {0.7}}));
  ASSERT_TRUE(chain.effects.add({EffectKind::kTorqueScale, 1, {-0.2}}));
  ASSERT_TRUE(chain.effects.add({EffectKind::kTorqueOffset, 1, {1.5}}));
  ASSERT_EQ(validate(chain), Status::kOk);
  const auto model = make_model(chain);
  for (int sample = 0; sample < 300; ++sample) {
    const auto q = random_vector<2, double>(generator, 3.0);
    const auto dq = random_vector<2, double>(generator, 0.5);
    const auto ddq = random_vector<2, double>(generator, 5.0);
    const Eigen::Vector2d load = arm.torque(q, dq, ddq);
    const double friction = 0.3 * std::fabs(load[0]) * std::tanh(dq[0] / 0.2);
    const Eigen::Vector2d expected(1.25 * (load[0] + friction + 0.7 * dq[0]),
                                   0.8 * (load[1] + 1.5));
    EXPECT_LE(deviation(inverse_dynamics(model, q, dq, ddq, 0.0), expected), 1e-12);
    ForwardDynamics<2, double> forward;
    ASSERT_EQ(forward_dynamics(model, q, dq, expected, 0.0, forward), Status::kOk);
    EXPECT_LE(deviation(forward.ddq, ddq), 1e-10);
    const Eigen::Vector2d still = arm.bias(q, dq);
    const double held = 0.3 * std::fabs(still[0]) * std::tanh(dq[0] / 0.2);
    const Eigen::Vector2d without(1.25 * (still[0] + held + 0.7 * dq[0]), 0.8 * (still[1] + 1.5));
    EXPECT_LE(deviation(bias_torque(model, q, dq, 0.0), without), 1e-12);
  }
}

TEST(TorquePath, FrictionByTheLoadNeverGivesEnergyAndNeedsMotion) {
  std::mt19937_64 generator = seeded_generator();
  for (int sample = 0; sample < 200; ++sample) {
    Chain<2, double> chain = random_chain<2, double>(generator);
    const auto bare = make_model(chain);
    for (const std::uint8_t joint : {std::uint8_t{0}, std::uint8_t{1}}) {
      ASSERT_TRUE(chain.effects.add({EffectKind::kLoadDependentFriction, joint, {0.4, 0.05}}));
      ASSERT_TRUE(chain.effects.add({EffectKind::kGearLoss, joint, {0.1, 0.9, 0.2}}));
    }
    const auto model = make_model(chain);
    const auto q = random_vector<2, double>(generator, 3.0);
    const auto dq = random_vector<2, double>(generator, 1.0);
    const auto ddq = random_vector<2, double>(generator, 5.0);
    const Eigen::Vector2d friction =
        inverse_dynamics(model, q, dq, ddq, 0.0) - inverse_dynamics(bare, q, dq, ddq, 0.0);
    EXPECT_GE(friction[0] * dq[0], 0);
    EXPECT_GE(friction[1] * dq[1], 0);
    EXPECT_GT(friction.norm(), 0);
    const Eigen::Vector2d rest = Eigen::Vector2d::Zero();
    EXPECT_EQ(inverse_dynamics(model, q, rest, ddq, 0.0),
              inverse_dynamics(bare, q, rest, ddq, 0.0));
  }
}

TEST(TorquePath, ToldPerLoadIsTheSlopeOfTheInverseDynamics) {
  std::mt19937_64 generator = seeded_generator();
  for (int sample = 0; sample < 200; ++sample) {
    const auto model = make_model(chain_with_path<2, double>(generator));
    const auto q = random_vector<2, double>(generator, 3.0);
    const auto dq = random_vector<2, double>(generator, 1.0);
    const auto tau = random_vector<2, double>(generator, 50.0);
    ForwardDynamics<2, double> at;
    ASSERT_EQ(forward_dynamics(model, q, dq, tau, 0.0, at), Status::kOk);
    const Eigen::Vector2d more = 1e-7 * random_vector<2, double>(generator, 1.0);
    const Eigen::Vector2d told = inverse_dynamics<2, double>(model, q, dq, at.ddq + more, 0.0) -
                                 inverse_dynamics(model, q, dq, at.ddq, 0.0);
    const Eigen::Vector2d expected = at.told_per_load.cwiseProduct(at.inertia * more);
    EXPECT_LE((told - expected).norm(), 1e-4 * expected.norm() + 1e-11);
  }
}

// Whatever friction takes of either direction of power, as long as some of the load is left.
TEST(TorquePath, FrictionByTheDirectionOfPowerIsTakenBackExactly) {
  std::mt19937_64 generator = seeded_generator();
  RigidBodyModel<2, double> model;
  model.has_torque_path = true;
  for (int sample = 0; sample < 300; ++sample) {
    model.told_per_given = Eigen::Vector2d(uniform(generator, 0.3, 3), uniform(generator, 0.3, 3));
    JointEffects<2, double> effects;
    effects.torque = random_vector<2, double>(generator, 5.0);
    for (Eigen::Index i = 0; i < 2; ++i) {
      effects.friction_by_load[i] = uniform(generator, -0.5, 1.5);
      const double most = 0.95 * (1 + effects.friction_by_load[i]);
      effects.friction_by_size[i] = uniform(generator, -most, most);
    }
    const auto load = random_vector<2, double>(generator, 10.0);
    const Eigen::Vector2d told = drive_torque<2, double>(model, effects, load);
    for (Eigen::Index i = 0; i < 2; ++i) {
      const double friction =
          effects.friction_by_size[i] * std::fabs(load[i]) + effects.friction_by_load[i] * load[i];
      EXPECT_NEAR(told[i], model.told_per_given[i] * (load[i] + friction + effects.torque[i]),
                  1e-12 * (1 + std::fabs(told[i])));
    }
    EXPECT_LE(deviation(load_torque<2, double>(model, effects, told), load), 1e-11);
    // The slope is that of the side of zero where the load lies.
    const Eigen::Vector2d more = 1e-6 * load;
    const Eigen::Vector2d slope =
        (drive_torque<2, double>(model, effects, load + more) - told).cwiseQuotient(more);
    EXPECT_LE(deviation(told_per_load<2, double>(model, effects, load), slope), 1e-6);
  }
}

// Far from standstill a gear is its two efficiencies.
TEST(TorquePath, AGearHasItsOwnEfficiencyInEitherDirectionOfPower) {
  const double driving = 0.8;
  const double driven = 0.7;
  Chain<1, double> chain;
  chain.joints[0].centre_of_mass_m = {1, 0, 0};
  chain.gravity_m_s2 = {0, -10, 0};
  const auto bare = make_model(chain);
  ASSERT_TRUE(chain.effects.add({EffectKind::kGearLoss, 0, {1 - driven, 1 / driving - 1, 0.01}}));
  ASSERT_EQ(validate(chain), Status::kOk);
  const auto model = make_model(chain);
  int driving_seen = 0;
  int driven_seen = 0;
  for (const double q : {-2.0, -0.4, 0.3, 2.9}) {
    for (const double dq : {-1.0, 1.0}) {
      using V = Vector<1, double>;
      const V none = V::Zero();
      const double load = inverse_dynamics<1, double>(bare, V(q), V(dq), none, 0)[0];
      const double told = inverse_dynamics<1, double>(model, V(q), V(dq), none, 0)[0];
      const bool drives = load * dq > 0;
      EXPECT_NEAR(told, drives ? load / driving : load * driven, 1e-12);
      ++(drives ? driving_seen : driven_seen);
      // Nothing is lost at rest, and nothing jumps where the load passes zero.
      EXPECT_EQ((inverse_dynamics<1, double>(model, V(q), none, none, 0)[0]),
                (inverse_dynamics<1, double>(bare, V(q), none, none, 0)[0]));
    }
  }
  EXPECT_EQ(driving_seen, 4);
  EXPECT_EQ(driven_seen, 4);
}

TEST(TorquePath, AGearWithEqualLossesIsFrictionByTheLoad) {
  std::mt19937_64 generator = seeded_generator();
  Chain<2, double> gear = random_chain<2, double>(generator);
  Chain<2, double> friction = gear;
  ASSERT_TRUE(gear.effects.add({EffectKind::kGearLoss, 1, {0.4, 0.4, 0.2}}));
  ASSERT_TRUE(friction.effects.add({EffectKind::kLoadDependentFriction, 1, {0.4, 0.2}}));
  for (int sample = 0; sample < 100; ++sample) {
    const auto q = random_vector<2, double>(generator, 3.0);
    const auto dq = random_vector<2, double>(generator, 0.4);
    const auto ddq = random_vector<2, double>(generator, 5.0);
    EXPECT_LE(deviation(inverse_dynamics(make_model(gear), q, dq, ddq, 0.0),
                        inverse_dynamics(make_model(friction), q, dq, ddq, 0.0)),
              1e-12);
  }
}

// The most that a gear takes where the load drives it is what keeps the inverse single-valued: no
// velocity may take more.
TEST(TorquePath, AGearTakesNoMoreOfALoadThatDrivesItThanItSays) {
  std::mt19937_64 generator = seeded_generator();
  for (int sample = 0; sample < 200; ++sample) {
    const std::array<double, kMaxEffectParameters> p{
        uniform(generator, 0, 0.95), uniform(generator, 0, effects::GearLoss::kMostDrivingLoss),
        0.1};
    const double most = effects::GearLoss::most_friction_per_load(p);
    double seen = 0;
    for (double dq = 0; dq < 1; dq += 1e-3) {
      const auto at = effects::GearLoss::friction_per_load(p, JointInstant<double>{0, dq, 0});
      seen = std::max(seen, at.by_size - at.by_load);
      EXPECT_GE(at.by_size, std::abs(at.by_load));  // against the motion, whatever the load
    }
    EXPECT_LE(seen, most + 1e-12);
    EXPECT_GT(seen, most - 1e-4);
    EXPECT_LT(most, 1);
  }
}

TEST(TorquePath, WithoutSuchEffectsNothingIsScaled) {
  std::mt19937_64 generator = seeded_generator();
  Chain<2, double> chain = random_chain<2, double>(generator);
  ASSERT_TRUE(chain.effects.add({EffectKind::kCoulombFriction, 0, {1, 0.1}}));
  const auto model = make_model(chain);
  EXPECT_FALSE(model.has_torque_path);
  const Eigen::Vector2d at(0.3, 0.4);
  ForwardDynamics<2, double> result;
  ASSERT_EQ((forward_dynamics<2, double>(model, at, at, at, 0.0, result)), Status::kOk);
  EXPECT_EQ(result.told_per_load, Eigen::Vector2d::Ones());
}

// The loop that computed torque closes stays linear and decoupled: the command is what the drive
// has to be told.
TEST(TorquePath, ComputedTorqueReachesTheAccelerationThatItAsksFor) {
  std::mt19937_64 generator = seeded_generator();
  const ComputedTorqueGains<2, double> gains{{25, 16}, {10, 8}};
  for (int sample = 0; sample < 200; ++sample) {
    const auto model = make_model(chain_with_path<2, double>(generator));
    const Reference<2, double> reference{random_vector<2, double>(generator, 2),
                                         random_vector<2, double>(generator, 2),
                                         random_vector<2, double>(generator, 2)};
    const auto q = random_vector<2, double>(generator, 2);
    const auto dq = random_vector<2, double>(generator, 2);
    const Eigen::Vector2d tau = computed_torque(model, gains, reference, q, dq, 0.4);
    ForwardDynamics<2, double> forward;
    ASSERT_EQ(forward_dynamics(model, q, dq, tau, 0.4, forward), Status::kOk);
    for (Eigen::Index i = 0; i < 2; ++i) {
      const auto joint = static_cast<std::size_t>(i);
      const double expected = reference.ddq[i] + gains.kd[joint] * (reference.dq[i] - dq[i]) +
                              gains.kp[joint] * (reference.q[i] - q[i]);
      EXPECT_NEAR(forward.ddq[i], expected, 1e-8 * (1 + forward.ddq.norm()));
    }
  }
}

}  // namespace
}  // namespace offnominal::test
