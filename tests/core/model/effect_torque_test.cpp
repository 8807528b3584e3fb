#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <offnominal/model/effect_memory.hpp>
#include <offnominal/model/inverse_dynamics.hpp>
#include <string>

#include "core/model/random_chain.hpp"
#include "core/print_status.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

using Parameters = std::array<double, kMaxEffectParameters>;

// An effect's formula as its documentation states it, in the C library's own functions.
struct Formula {
  EffectKind kind;
  JointType type;
  std::function<Parameters(std::mt19937_64&)> draw;
  std::function<double(const Parameters&, double q, double dq, double t)> torque;
};

double level(std::mt19937_64& g) { return uniform(g, -5, 5); }
double width(std::mt19937_64& g) { return uniform(g, 0.005, 0.5); }

std::vector<Formula> formulas_of(JointType type) {
  const double per_position = type == JointType::kRevolute ? 1 : 2 * std::numbers::pi;
  return {
      {EffectKind::kViscousFriction, type, [](auto& g) { return Parameters{level(g)}; },
       [](const Parameters& p, double, double dq, double) { return p[0] * dq; }},
      {EffectKind::kCoulombFriction, type,
       [](auto& g) {
         return Parameters{level(g), width(g)};
       },
       [](const Parameters& p, double, double dq, double) { return p[0] * std::tanh(dq / p[1]); }},
      {EffectKind::kFrictionAsymmetry, type,
       [](auto& g) {
         return Parameters{level(g), level(g), width(g)};
       },
       [](const Parameters& p, double, double dq, double) {
         const double s = std::tanh(dq / p[2]);
         return p[0] * s * s + p[1] * dq * s;
       }},
      {EffectKind::kTorqueOffset, type, [](auto& g) { return Parameters{level(g)}; },
       [](const Parameters& p, double, double, double) { return p[0]; }},
      {EffectKind::kStribeckFriction, type,
       [](auto& g) {
         return Parameters{level(g), uniform(g, 0.05, 1), width(g)};
       },
       [](const Parameters& p, double, double dq, double) {
         return p[0] * std::exp(-std::pow(dq / p[1], 2)) * std::tanh(dq / p[2]);
       }},
      {EffectKind::kQuadraticFriction, type, [](auto& g) { return Parameters{level(g)}; },
       [](const Parameters& p, double, double dq, double) { return p[0] * dq * std::fabs(dq); }},
      {EffectKind::kJointStiffness, type,
       [](auto& g) {
         return Parameters{level(g), uniform(g, -1, 1)};
       },
       [](const Parameters& p, double q, double, double) { return p[0] * (q - p[1]); }},
      {EffectKind::kCoggingTorque, type,
       [](auto& g) {
         return Parameters{level(g), level(g), uniform(g, 1, 12)};
       },
       [per_position](const Parameters& p, double q, double, double) {
         const double phase = per_position * p[2] * q;
         return p[0] * std::sin(phase) + p[1] * std::cos(phase);
       }},
      {EffectKind::kPeriodicDisturbance, type,
       [](auto& g) {
         return Parameters{level(g), level(g), uniform(g, 1, 30)};
       },
       [](const Parameters& p, double, double, double t) {
         return p[0] * std::sin(p[2] * t) + p[1] * std::cos(p[2] * t);
       }},
      {EffectKind::kTemperatureDrift, type,
       [](auto& g) {
         return Parameters{level(g), level(g), uniform(g, 0.5, 20), width(g)};
       },
       [](const Parameters& p, double, double dq, double t) {
         return std::exp(-t / p[2]) * (p[0] * std::tanh(dq / p[3]) + p[1] * dq);
       }},
  };
}

std::vector<Formula> all_formulas() {
  std::vector<Formula> all = formulas_of(JointType::kRevolute);
  for (Formula& formula : formulas_of(JointType::kPrismatic)) all.push_back(std::move(formula));
  return all;
}

const char* type_name(JointType type) {
  return type == JointType::kRevolute ? "revolute" : "prismatic";
}

template <typename Scalar>
Effect<Scalar> effect_at_second_joint(const Formula& formula, const Parameters& parameters) {
  Effect<Scalar> effect{formula.kind, 1, {}};
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    effect.parameters[i] = static_cast<Scalar>(parameters[i]);
  }
  return effect;
}

template <typename Scalar>
Parameters rounded(const Effect<Scalar>& effect) {
  Parameters parameters{};
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    parameters[i] = static_cast<double>(effect.parameters[i]);
  }
  return parameters;
}

template <typename Scalar>
double worst_against_formula(const Formula& formula, std::mt19937_64& generator) {
  double worst = 0;
  for (int sample = 0; sample < 500; ++sample) {
    Chain<2, Scalar> chain = random_chain<2, Scalar>(generator);
    chain.joints[1].type = formula.type;
    const auto bare = make_model(chain);
    const auto effect = effect_at_second_joint<Scalar>(formula, formula.draw(generator));
    EXPECT_TRUE(chain.effects.add(effect));
    EXPECT_EQ(validate(chain), Status::kOk);
    const auto model = make_model(chain);
    const auto q = random_vector<2, Scalar>(generator, 2.0);
    // A width that reaches all the way from the middle of the smoothed sign to its ends.
    const auto dq = random_vector<2, Scalar>(generator, uniform(generator, 0, 1) < 0.5 ? 0.2 : 3);
    const auto ddq = random_vector<2, Scalar>(generator, 3.0);
    const double time_s = uniform(generator, 0, 2);
    const Vector<2, Scalar> torque = effect_torque(model, q, dq, time_s);
    const Vector<2, Scalar> whole = inverse_dynamics(model, q, dq, ddq, time_s);
    EXPECT_EQ(torque[0], Scalar(0));
    EXPECT_EQ(whole, (inverse_dynamics(bare, q, dq, ddq, time_s) + torque).eval());
    const double expected = formula.torque(rounded(effect), static_cast<double>(q[1]),
                                           static_cast<double>(dq[1]), time_s);
    const double difference = std::fabs(static_cast<double>(torque[1]) - expected);
    worst = difference <= worst ? worst : difference;
  }
  return worst;
}

class EffectTorque : public testing::TestWithParam<Formula> {};

TEST_P(EffectTorque, EqualsItsDocumentedFormula) {
  std::mt19937_64 generator = seeded_generator();
  EXPECT_LE(worst_against_formula<double>(GetParam(), generator), 1e-12);
  // A phase of up to 2 * 75 rad is known to half of 2^-17 rad in float, its sine with it, times two
  // amplitudes of up to 5; everything else is rounded far finer.
  EXPECT_LE(worst_against_formula<float>(GetParam(), generator), 2 * 5 * 0x1p-16);
}

// No jump and no kink that an order-4 integrator would stumble over: the slope to the left equals
// the slope to the right, at standstill and at random points.
TEST_P(EffectTorque, IsSmoothInPositionVelocityAndTime) {
  std::mt19937_64 generator = seeded_generator();
  Chain<2, double> chain = random_chain<2, double>(generator);
  chain.joints[1].type = GetParam().type;
  ASSERT_TRUE(
      chain.effects.add(effect_at_second_joint<double>(GetParam(), GetParam().draw(generator))));
  const auto model = make_model(chain);
  for (int sample = 0; sample < 200; ++sample) {
    const Eigen::Vector3d at =
        sample == 0 ? Eigen::Vector3d(0.3, 0, 0.4) : random_vector3(generator, 1.0).eval();
    const auto torque_at = [&](const Eigen::Vector3d& point) {
      return effect_torque<2, double>(model, {0, point[0]}, {0, point[1]}, point[2])[1];
    };
    for (Eigen::Index along = 0; along < 3; ++along) {
      const double h = 1e-6;
      const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(along);
      const double right = (torque_at(at + step) - torque_at(at)) / h;
      const double left = (torque_at(at) - torque_at(at - step)) / h;
      // The curvature times h, at most 5 / (0.005 rad/s)^2 here.
      EXPECT_NEAR(right, left, 0.5);
    }
  }
}

TEST_P(EffectTorque, GivesNaNForNaNWhereItDependsOnTheMotion) {
  std::mt19937_64 generator = seeded_generator();
  const bool depends = GetParam().kind != EffectKind::kTorqueOffset;
  Chain<2, float> chain = random_chain<2, float>(generator);
  chain.joints[1].type = GetParam().type;
  ASSERT_TRUE(
      chain.effects.add(effect_at_second_joint<float>(GetParam(), GetParam().draw(generator))));
  const auto model = make_model(chain);
  const Vector<2, float> bad = Vector<2, float>::Constant(std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(std::isnan(effect_torque(model, bad, bad, static_cast<double>(bad[0]))[1]), depends);
}

INSTANTIATE_TEST_SUITE_P(All, EffectTorque, testing::ValuesIn(all_formulas()),
                         [](const testing::TestParamInfo<Formula>& tested) {
                           return std::string(info_of(tested.param.kind)->name) + "_" +
                                  type_name(tested.param.type);
                         });

// Least squares may trust ParameterRole::kLinear: twice the linear parameters is twice the torque.
TEST(EffectRoles, TheTorqueIsProportionalToTheLinearParameters) {
  std::mt19937_64 generator = seeded_generator();
  for (const EffectInfo& info : kAllEffectInfos) {
    if (remembers(info.kind)) continue;  // effect_memory_test.cpp
    Chain<2, double> chain = random_chain<2, double>(generator);
    Effect<double> effect{info.kind, 1, {}};
    Effect<double> doubled = effect;
    for (std::size_t i = 0; i < info.parameters.size(); ++i) {
      effect.parameters[i] = uniform(generator, 0.1, 2);
      if (info.parameters[i].quantity == Quantity::kJointNumber) effect.parameters[i] = 1;
      const bool linear = info.parameters[i].role == ParameterRole::kLinear;
      doubled.parameters[i] = (linear ? 2 : 1) * effect.parameters[i];
    }
    Chain<2, double> once = chain;
    Chain<2, double> twice = chain;
    ASSERT_TRUE(once.effects.add(effect));
    ASSERT_TRUE(twice.effects.add(doubled));
    const auto q = random_vector<2, double>(generator, 2.0);
    // Slow enough for the Stribeck effect to be there.
    const Eigen::Vector2d dq = Eigen::Vector2d::Constant(uniform(generator, 0.05, 0.15));
    const auto ddq = random_vector<2, double>(generator, 3.0);
    const auto torque = [&](const Chain<2, double>& of) {
      return inverse_dynamics(make_model(of), q, dq, ddq, 0.7).eval();
    };
    const Eigen::Vector2d effect_once = torque(once) - torque(chain);
    const Eigen::Vector2d effect_twice = torque(twice) - torque(chain);
    EXPECT_LE(deviation(effect_twice, 2 * effect_once), 1e-11) << info.name;
    EXPECT_GT(effect_once.norm(), 1e-6) << info.name;
  }
}

class FrictionSign : public testing::TestWithParam<EffectKind> {};

TEST_P(FrictionSign, APositiveCoefficientTakesEnergyOutOfTheJoint) {
  Chain<1, double> chain;
  ASSERT_TRUE(chain.effects.add({GetParam(), 0, {2.0, 0.5, 0.01}}));
  const auto model = make_model(chain);
  for (const double velocity : {-3.0, -0.2, -1e-3, 1e-3, 0.2, 3.0}) {
    const Vector<1, double> at(velocity);
    EXPECT_GT(effect_torque(model, at, at, 0.0)[0] * velocity, 0) << velocity;
  }
}

INSTANTIATE_TEST_SUITE_P(All, FrictionSign,
                         testing::Values(EffectKind::kViscousFriction, EffectKind::kCoulombFriction,
                                         EffectKind::kStribeckFriction,
                                         EffectKind::kQuadraticFriction),
                         [](const testing::TestParamInfo<EffectKind>& tested) {
                           return std::string(info_of(tested.param)->name);
                         });

TEST(TemperatureDrift, TakesEnergyOutOfTheJointAndFadesToNothing) {
  Chain<1, double> chain;
  ASSERT_TRUE(chain.effects.add({EffectKind::kTemperatureDrift, 0, {2.0, 0.5, 4.0, 0.01}}));
  const auto model = make_model(chain);
  for (const double velocity : {-3.0, -1e-3, 1e-3, 0.2, 3.0}) {
    const Vector<1, double> at(velocity);
    const double cold = effect_torque(model, at, at, 0.0)[0];
    EXPECT_GT(cold * velocity, 0) << velocity;
    EXPECT_NEAR(effect_torque(model, at, at, 4.0)[0], cold * std::exp(-1.0), 1e-12);
    EXPECT_NEAR(effect_torque(model, at, at, 400.0)[0], 0, 1e-12);
  }
}

// By the definition, in the C library's own functions: the torque follows the other joint,
// whichever it is, and nothing else.
template <typename Scalar>
void expect_coupling_follows_its_source(std::mt19937_64& generator, double tolerance) {
  for (int sample = 0; sample < 300; ++sample) {
    Chain<3, Scalar> chain = random_chain<3, Scalar>(generator);
    const auto joint = static_cast<std::uint8_t>(sample % 3);
    const int source = (sample % 3 + 1 + sample % 2) % 3;
    const Effect<Scalar> effect{
        EffectKind::kJointCoupling,
        joint,
        {static_cast<Scalar>(level(generator)), static_cast<Scalar>(level(generator)),
         static_cast<Scalar>(source + 1), static_cast<Scalar>(width(generator))}};
    ASSERT_TRUE(chain.effects.add(effect));
    ASSERT_EQ(validate(chain), Status::kOk);
    const auto q = random_vector<3, Scalar>(generator, 2.0);
    const auto dq = random_vector<3, Scalar>(generator, 1.0);
    const auto torque = effect_torque(make_model(chain), q, dq, 0.3);
    const auto p = rounded(effect);
    const auto other = static_cast<double>(dq[source]);
    Eigen::Vector3d expected = Eigen::Vector3d::Zero();
    expected[joint] = p[0] * other + p[1] * std::tanh(other / p[3]);
    EXPECT_LE(deviation(torque, expected), tolerance);
  }
}

TEST(JointCoupling, FollowsTheJointThatItNamesAndNothingElse) {
  std::mt19937_64 generator = seeded_generator();
  expect_coupling_follows_its_source<double>(generator, 1e-13);
  expect_coupling_follows_its_source<float>(generator, 1e-5);
}

TEST(JointCoupling, GivenAJointThatIsNotThereThenTheModelLeavesItOutAndDoesNotCrash) {
  std::mt19937_64 generator = seeded_generator();
  for (const double source : {0.0, 1.0, 3.0, 1e30, std::numeric_limits<double>::quiet_NaN()}) {
    Chain<2, double> chain = random_chain<2, double>(generator);
    ASSERT_TRUE(chain.effects.add({EffectKind::kJointCoupling, 0, {1, 1, source, 0.1}}));
    EXPECT_EQ(make_model(chain).torque_effects.view().size(), 0U) << source;
  }
}

TEST(FrictionAsymmetry, BesideCoulombAndViscousFrictionEachDirectionHasItsOwnLevelAndSlope) {
  Chain<1, double> chain;
  ASSERT_TRUE(chain.effects.add({EffectKind::kCoulombFriction, 0, {3.0, 0.01}}));
  ASSERT_TRUE(chain.effects.add({EffectKind::kViscousFriction, 0, {2.0}}));
  ASSERT_TRUE(chain.effects.add({EffectKind::kFrictionAsymmetry, 0, {0.5, 0.25, 0.01}}));
  const auto model = make_model(chain);
  const auto torque = [&](double velocity) {
    const Vector<1, double> dq(velocity);
    return effect_torque(model, dq, dq, 0.0)[0];
  };
  EXPECT_NEAR(torque(1.0), 3.5 + 2.25 * 1.0, 1e-12);
  EXPECT_NEAR(torque(2.0), 3.5 + 2.25 * 2.0, 1e-12);
  EXPECT_NEAR(torque(-1.0), -2.5 - 1.75 * 1.0, 1e-12);
  EXPECT_NEAR(torque(-2.0), -2.5 - 1.75 * 2.0, 1e-12);
}

}  // namespace
}  // namespace offnominal::test
