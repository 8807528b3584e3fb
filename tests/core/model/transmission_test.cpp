#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <offnominal/model/forward_dynamics.hpp>

#include "core/model/random_chain.hpp"
#include "core/model/two_link_closed_form.hpp"
#include "core/print_status.hpp"
#include "support/seed.hpp"

// Effects on the shafts of motors, whatever lies between them and the joints.

namespace offnominal::test {
namespace {

template <typename Scalar>
Effect<Scalar> of_motor(EffectKind kind, int motor,
                        std::array<Scalar, kMaxEffectParameters> parameters) {
  return {kind, static_cast<std::uint8_t>(motor), parameters, true};
}

// Every motor moves every joint.
template <int N, typename Scalar>
Chain<N, Scalar> coupled_chain(std::mt19937_64& generator) {
  Chain<N, Scalar> chain = random_chain<N, Scalar>(generator);
  for (Scalar& one : chain.transmission.motor_per_joint) {
    one = static_cast<Scalar>(uniform(generator, -5, 5));
  }
  for (int motor = 0; motor < N; ++motor) {
    const auto number = [&](double low, double high) {
      return static_cast<Scalar>(uniform(generator, low, high));
    };
    EXPECT_TRUE(
        chain.effects.add(of_motor<Scalar>(EffectKind::kViscousFriction, motor, {number(0, 0.2)})));
    EXPECT_TRUE(chain.effects.add(
        of_motor<Scalar>(EffectKind::kCoulombFriction, motor, {number(0, 0.3), number(0.1, 0.5)})));
    EXPECT_TRUE(
        chain.effects.add(of_motor<Scalar>(EffectKind::kRotorInertia, motor, {number(0, 0.02)})));
    EXPECT_TRUE(chain.effects.add(of_motor<Scalar>(EffectKind::kCoggingTorque, motor,
                                                   {number(-1, 1), number(-1, 1), number(1, 4)})));
    chain.transmission.motor_offset_rad[static_cast<std::size_t>(motor)] = number(-3, 3);
  }
  EXPECT_EQ(validate(chain), Status::kOk);
  return chain;
}

TEST(MotorEffects, AreWorkedOutAsByHandForADifferential) {
  // q_m1 = 4 q1 + 2 q2 + 0.3, q_m2 = 4 q1 - 2 q2: at dq = (1, -1) motor 1 turns at 2, motor 2 at 6.
  Chain<2, double> chain;
  chain.gravity_m_s2 = {0, 0, 0};
  chain.transmission.motor_per_joint = {4, 2, 4, -2};
  chain.transmission.motor_offset_rad = {0.3, 0};
  const auto without = make_model(chain);
  ASSERT_TRUE(chain.effects.add(of_motor<double>(EffectKind::kViscousFriction, 0, {0.5})));
  ASSERT_TRUE(chain.effects.add(of_motor<double>(EffectKind::kQuadraticFriction, 1, {0.1})));
  ASSERT_TRUE(chain.effects.add(of_motor<double>(EffectKind::kRotorInertia, 1, {0.25})));
  ASSERT_TRUE(chain.effects.add(of_motor<double>(EffectKind::kJointStiffness, 0, {2, 1})));
  const auto model = make_model(chain);
  const Eigen::Vector2d q(0.1, 0.4);
  const Eigen::Vector2d dq(1, -1);
  const Eigen::Vector2d ddq(3, 1);
  // Motor 1: 0.5 * 2 + 2 (0.4 + 0.8 + 0.3 - 1) = 2. Motor 2: 0.1 * 36 + 0.25 (12 - 2) = 6.1.
  const Eigen::Vector2d expected(4 * 2 + 4 * 6.1, 2 * 2 - 2 * 6.1);
  const Eigen::Vector2d torque = inverse_dynamics<2, double>(model, q, dq, ddq, 0) -
                                 inverse_dynamics<2, double>(without, q, dq, ddq, 0);
  EXPECT_LT((torque - expected).norm(), 1e-12);
  const Eigen::Matrix2d added =
      mass_matrix<2, double>(model, q) - mass_matrix<2, double>(without, q);
  EXPECT_LT((added - 0.25 * (Eigen::Matrix2d() << 16, -8, -8, 4).finished()).norm(), 1e-12);
}

template <int N, typename Scalar>
void expect_inverse_of_each_other(double tolerance) {
  std::mt19937_64 generator = seeded_generator();
  for (int sample = 0; sample < 200; ++sample) {
    const auto model = make_model(coupled_chain<N, Scalar>(generator));
    const auto q = random_vector<N, Scalar>(generator, std::numbers::pi);
    const auto dq = random_vector<N, Scalar>(generator, 2.0);
    const auto tau = random_vector<N, Scalar>(generator, 20.0);
    ForwardDynamics<N, Scalar> forward;
    ASSERT_EQ(forward_dynamics(model, q, dq, tau, 1.0, forward), Status::kOk);
    EXPECT_LT(deviation(inverse_dynamics(model, q, dq, forward.ddq, 1.0), tau), tolerance);
  }
}

TEST(MotorEffects, ForwardAndInverseDynamicsAgree) {
  expect_inverse_of_each_other<3, double>(1e-9);
  expect_inverse_of_each_other<6, double>(1e-8);
  expect_inverse_of_each_other<2, float>(2e-3);
}

TEST(MotorEffects, FrictionOfMotorsTakesEnergyOutOfTheArm) {
  std::mt19937_64 generator = seeded_generator();
  for (int sample = 0; sample < 200; ++sample) {
    Chain<3, double> chain = coupled_chain<3, double>(generator);
    const auto all = chain.effects;
    chain.effects = {};
    for (const auto& effect : all.view()) {
      if (effect.kind == EffectKind::kViscousFriction ||
          effect.kind == EffectKind::kCoulombFriction) {
        ASSERT_TRUE(chain.effects.add(effect));
      }
    }
    const auto model = make_model(chain);
    const auto q = random_vector<3, double>(generator, 1.0);
    const auto dq = random_vector<3, double>(generator, 2.0);
    EXPECT_GT((effect_torque<3, double>(model, q, dq, 0).dot(dq)), 0);
  }
}

TEST(MotorEffects, OfOneGearEachAreThoseOfTheJointsReflected) {
  std::mt19937_64 generator = seeded_generator();
  const Chain<2, double> bare = random_chain<2, double>(generator);
  const double ratio[]{30, -12};
  Chain<2, double> at_motors = bare;
  Chain<2, double> at_joints = bare;
  for (std::uint8_t i = 0; i < 2; ++i) {
    const double r = ratio[i];
    at_motors.transmission.motor_per_joint[3U * i] = r;
    const auto add = [&](EffectKind kind, std::array<double, kMaxEffectParameters> motor,
                         std::array<double, kMaxEffectParameters> joint) {
      ASSERT_TRUE(at_motors.effects.add(of_motor<double>(kind, i, motor)));
      ASSERT_TRUE(at_joints.effects.add({kind, i, joint}));
    };
    add(EffectKind::kViscousFriction, {1e-3}, {1e-3 * r * r});
    add(EffectKind::kCoulombFriction, {0.02, 1.5}, {0.02 * std::abs(r), 1.5 / std::abs(r)});
    add(EffectKind::kRotorInertia, {2e-4}, {2e-4 * r * r});
    add(EffectKind::kTorqueOffset, {0.01}, {0.01 * r});
    add(EffectKind::kCoggingTorque, {0.03, 0.01, 6},
        {0.03 * std::abs(r), 0.01 * r, 6 * std::abs(r)});
  }
  const auto motors = make_model(at_motors);
  const auto joints = make_model(at_joints);
  for (int sample = 0; sample < 100; ++sample) {
    const auto q = random_vector<2, double>(generator, 1.0);
    const auto dq = random_vector<2, double>(generator, 1.0);
    const auto ddq = random_vector<2, double>(generator, 3.0);
    const Vector<2, double> a = inverse_dynamics<2, double>(motors, q, dq, ddq, 0);
    const Vector<2, double> b = inverse_dynamics<2, double>(joints, q, dq, ddq, 0);
    EXPECT_LT((a - b).norm(), 1e-10);
  }
}

TEST(MotorEffects, AreRefusedWhereAMotorCannotHaveThem) {
  for (const EffectInfo& info : kAllEffectInfos) {
    Chain<2, double> chain;
    Effect<double> effect = of_motor<double>(info.kind, 1, {});
    for (std::size_t i = 0; i < info.parameters.size(); ++i) {
      effect.parameters[i] = std::max(info.parameters[i].min, 0.0) + 1e-9;
      if (info.parameters[i].quantity == Quantity::kJointNumber) effect.parameters[i] = 1;
    }
    ASSERT_TRUE(chain.effects.add(effect));
    EXPECT_EQ(validate(chain), motor_may_have(info.kind) ? Status::kOk : Status::kInvalidEffect)
        << info.name;
  }
}

TEST(MotorEffects, NeedATransmissionOfNumbers) {
  Chain<2, double> chain;
  chain.transmission.motor_per_joint[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(validate(chain), Status::kInvalidEffect);
  chain.transmission = {};
  chain.transmission.motor_offset_rad[0] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(validate(chain), Status::kInvalidEffect);
}

}  // namespace
}  // namespace offnominal::test
