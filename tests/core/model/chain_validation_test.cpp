#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <offnominal/model/chain.hpp>
#include <string>

#include "core/model/random_chain.hpp"
#include "core/print_status.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Refusal {
  std::string name;
  std::function<void(Joint<double>&)> spoil;
  Status status;
};

std::vector<Refusal> refusals() {
  using J = Joint<double>;
  std::vector<Refusal> all{
      {"AxisNotUnit",
       [](J& j) {
         j.axis = {0, 0, 1.001};
       },
       Status::kInvalidAxis},
      {"AxisZero",
       [](J& j) {
         j.axis = {0, 0, 0};
       },
       Status::kInvalidAxis},
      {"RotationMirrored", [](J& j) { j.rotation = {1, 0, 0, 0, 1, 0, 0, 0, -1}; },
       Status::kInvalidRotation},
      {"RotationScaled", [](J& j) { j.rotation = {2, 0, 0, 0, 2, 0, 0, 0, 2}; },
       Status::kInvalidRotation},
      {"RotationSheared", [](J& j) { j.rotation = {1, 0.01, 0, 0, 1, 0, 0, 0, 1}; },
       Status::kInvalidRotation},
      {"RotationZero", [](J& j) { j.rotation = {}; }, Status::kInvalidRotation},
      {"MassZero", [](J& j) { j.mass_kg = 0; }, Status::kInvalidMass},
      {"MassNegative", [](J& j) { j.mass_kg = -1; }, Status::kInvalidMass},
      {"MassInfinite", [](J& j) { j.mass_kg = kInfinity; }, Status::kInvalidMass},
      {"MassNaN", [](J& j) { j.mass_kg = kNaN; }, Status::kInvalidMass},
      {"InertiaNegative", [](J& j) { j.inertia_kg_m2 = {-1, 1, 1, 0, 0, 0}; },
       Status::kInvalidInertia},
      {"InertiaAllNegative", [](J& j) { j.inertia_kg_m2 = {-1, -1, -1, 0, 0, 0}; },
       Status::kInvalidInertia},
      {"InertiaIndefinite", [](J& j) { j.inertia_kg_m2 = {1, 1, 1, 1.2, 0, 0}; },
       Status::kInvalidInertia},
      {"InertiaProductsOnly", [](J& j) { j.inertia_kg_m2 = {0, 0, 0, 0.1, 0, 0}; },
       Status::kInvalidInertia},
      {"InertiaOfOneAxisOnly", [](J& j) { j.inertia_kg_m2 = {1, 0, 0, 0, 0, 0}; },
       Status::kInvalidInertia},
      {"InertiaAgainstTheTriangleInequality", [](J& j) { j.inertia_kg_m2 = {1, 1, 2.01, 0, 0, 0}; },
       Status::kInvalidInertia},
      {"InertiaAgainstTheTriangleInequalityBehindProducts",
       // Principal moments 0.5, 1.5 about turned axes, and 2.1.
       [](J& j) { j.inertia_kg_m2 = {1, 1, 2.1, 0.5, 0, 0}; }, Status::kInvalidInertia},
      {"PositionRangeEmpty", [](J& j) { j.min_position = j.max_position = 1; },
       Status::kInvalidLimit},
      {"PositionRangeReversed",
       [](J& j) {
         j.min_position = 1;
         j.max_position = -1;
       },
       Status::kInvalidLimit},
      {"MinPositionNaN", [](J& j) { j.min_position = kNaN; }, Status::kInvalidLimit},
      {"MaxPositionNaN", [](J& j) { j.max_position = kNaN; }, Status::kInvalidLimit},
      {"MaxVelocityZero", [](J& j) { j.max_velocity = 0; }, Status::kInvalidLimit},
      {"MaxVelocityNegative", [](J& j) { j.max_velocity = -1; }, Status::kInvalidLimit},
      {"MaxVelocityNaN", [](J& j) { j.max_velocity = kNaN; }, Status::kInvalidLimit},
      {"MaxTorqueZero", [](J& j) { j.max_torque = 0; }, Status::kInvalidLimit},
      {"MaxTorqueNegative", [](J& j) { j.max_torque = -1; }, Status::kInvalidLimit},
      {"MaxTorqueNaN", [](J& j) { j.max_torque = kNaN; }, Status::kInvalidLimit},
  };
  for (std::size_t i = 0; i < 3; ++i) {
    for (const double bad : {kNaN, kInfinity, -kInfinity}) {
      const std::string name = "Component" + std::to_string(i) +
                               (std::isnan(bad) ? "NaN"
                                : bad > 0       ? "Infinite"
                                                : "MinusInfinite");
      all.push_back({"Axis" + name, [=](J& j) { j.axis[i] = bad; }, Status::kInvalidAxis});
      all.push_back({"Origin" + name, [=](J& j) { j.origin_m[i] = bad; }, Status::kInvalidOrigin});
      all.push_back({"CentreOfMass" + name, [=](J& j) { j.centre_of_mass_m[i] = bad; },
                     Status::kInvalidInertia});
    }
  }
  for (std::size_t i = 0; i < 9; ++i) {
    all.push_back({"RotationElement" + std::to_string(i) + "NaN",
                   [=](J& j) { j.rotation[i] = kNaN; }, Status::kInvalidRotation});
  }
  for (std::size_t i = 0; i < 6; ++i) {
    for (const double bad : {kNaN, kInfinity}) {
      all.push_back({"InertiaElement" + std::to_string(i) + (std::isnan(bad) ? "NaN" : "Infinite"),
                     [=](J& j) { j.inertia_kg_m2[i] = bad; }, Status::kInvalidInertia});
    }
  }
  return all;
}

Joint<double> usable_joint() {
  Joint<double> joint;
  joint.inertia_kg_m2 = {0.3, 0.4, 0.5, 0.02, 0.01, -0.03};
  return joint;
}

class JointValidation : public testing::TestWithParam<Refusal> {};

TEST_P(JointValidation, RefusesWithItsOwnStatus) {
  Joint<double> joint = usable_joint();
  ASSERT_EQ(validate(joint), Status::kOk);
  GetParam().spoil(joint);
  EXPECT_EQ(validate(joint), GetParam().status);
  Chain<2, double> chain;
  chain.joints[1] = joint;
  EXPECT_EQ(validate(chain), GetParam().status);
}

INSTANTIATE_TEST_SUITE_P(All, JointValidation, testing::ValuesIn(refusals()),
                         [](const testing::TestParamInfo<Refusal>& tested) {
                           return tested.param.name;
                         });

template <typename Scalar>
Joint<Scalar> with_inertia(const Eigen::Matrix3d& inertia) {
  Joint<Scalar> joint;
  joint.inertia_kg_m2 = {static_cast<Scalar>(inertia(0, 0)), static_cast<Scalar>(inertia(1, 1)),
                         static_cast<Scalar>(inertia(2, 2)), static_cast<Scalar>(inertia(0, 1)),
                         static_cast<Scalar>(inertia(0, 2)), static_cast<Scalar>(inertia(1, 2))};
  return joint;
}

template <typename Scalar>
void expect_thin_bodies_accepted(std::mt19937_64& generator) {
  EXPECT_EQ(validate(with_inertia<Scalar>(Eigen::Matrix3d::Zero())), Status::kOk);
  for (int sample = 0; sample < 2000; ++sample) {
    const double size = std::pow(10, uniform(generator, -6, 3));
    const Eigen::Matrix3d turn = random_rotation(generator);
    const auto body = [&](const Eigen::Vector3d& moments) {
      const Eigen::Matrix3d turned = turn * (size * moments).asDiagonal() * turn.transpose();
      return with_inertia<Scalar>(turned);
    };
    const double thickness = uniform(generator, 0, 1);
    EXPECT_EQ(validate(body({1, 1, 0})), Status::kOk) << "rod of length only";
    EXPECT_EQ(validate(body({1, 1, 1e-3})), Status::kOk) << "rod";
    EXPECT_EQ(validate(body({1, thickness, 1 + thickness})), Status::kOk) << "plate";
  }
}

TEST(JointValidation, AcceptsPointMassesThinRodsAndPlates) {
  std::mt19937_64 generator = seeded_generator();
  expect_thin_bodies_accepted<double>(generator);
  expect_thin_bodies_accepted<float>(generator);
}

// A violation by 1 % of the largest moment is seen in float too.
template <typename Scalar>
void expect_impossible_bodies_refused(std::mt19937_64& generator) {
  for (int sample = 0; sample < 2000; ++sample) {
    const double size = std::pow(10, uniform(generator, -6, 3));
    const Eigen::Matrix3d turn = random_rotation(generator);
    const auto body = [&](const Eigen::Vector3d& moments) {
      const Eigen::Matrix3d turned = turn * (size * moments).asDiagonal() * turn.transpose();
      return with_inertia<Scalar>(turned);
    };
    const double a = uniform(generator, 0, 1);
    const double b = uniform(generator, 0, 1);
    EXPECT_EQ(validate(body({a, b, (a + b) * 1.01 + 1e-2})), Status::kInvalidInertia);
    EXPECT_EQ(validate(body({1, 1, -0.01})), Status::kInvalidInertia);
  }
}

TEST(JointValidation, RefusesBodiesThatCannotBe) {
  std::mt19937_64 generator = seeded_generator();
  expect_impossible_bodies_refused<double>(generator);
  expect_impossible_bodies_refused<float>(generator);
}

TEST(JointValidation, AcceptsRandomChainsInBothScalars) {
  std::mt19937_64 generator = seeded_generator();
  for (int sample = 0; sample < 500; ++sample) {
    EXPECT_EQ(validate(random_chain<6, double>(generator)), Status::kOk);
    EXPECT_EQ(validate(random_chain<6, float>(generator)), Status::kOk);
  }
}

TEST(ChainValidation, RefusesGravityThatIsNotFinite) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (const double bad : {kNaN, kInfinity}) {
      Chain<1, double> chain;
      chain.gravity_m_s2[i] = bad;
      EXPECT_EQ(validate(chain), Status::kInvalidGravity);
    }
  }
  Chain<1, double> weightless;
  weightless.gravity_m_s2 = {0, 0, 0};
  EXPECT_EQ(validate(weightless), Status::kOk);
}

TEST(ChainValidation, RefusesAnEffectOfAJointThatIsNotThere) {
  Chain<2, double> chain;
  ASSERT_TRUE(chain.effects.add({EffectKind::kViscousFriction, 2, {1.0}}));
  EXPECT_EQ(validate(chain), Status::kInvalidEffect);
}

TEST(ChainValidation, RefusesANumberThatIsNoEffect) {
  Chain<2, double> chain;
  ASSERT_TRUE(chain.effects.add({static_cast<EffectKind>(200), 0, {1.0}}));
  EXPECT_EQ(validate(chain), Status::kInvalidEffect);
}

TEST(ChainValidation, RefusesMoreEffectsThanItHasRoomFor) {
  Chain<1, double> chain;
  chain.effects.size = static_cast<std::uint8_t>(chain.effects.items.size());
  EXPECT_EQ(validate(chain), Status::kOk);
  chain.effects.size = static_cast<std::uint8_t>(chain.effects.items.size() + 1);
  EXPECT_EQ(validate(chain), Status::kTooManyEffects);
}

}  // namespace
}  // namespace offnominal::test
