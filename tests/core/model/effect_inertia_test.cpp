#include <gtest/gtest.h>

#include <numbers>
#include <offnominal/model/inverse_dynamics.hpp>
#include <offnominal/model/mass_matrix.hpp>

#include "core/model/random_chain.hpp"
#include "core/print_status.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

// The joint's link with a point mass at `at` made part of it: mass, centre of mass and inertia by
// the parallel-axis theorem.
Joint<double> with_mass(const Joint<double>& joint, double mass_kg, const Eigen::Vector3d& at) {
  const Eigen::Vector3d centre(joint.centre_of_mass_m.data());
  const double whole = joint.mass_kg + mass_kg;
  const Eigen::Vector3d new_centre = (joint.mass_kg * centre + mass_kg * at) / whole;
  const auto& [xx, yy, zz, xy, xz, yz] = joint.inertia_kg_m2;
  Eigen::Matrix3d inertia;
  inertia << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  const auto add = [&](double mass, const Eigen::Vector3d& d) {
    inertia += mass * (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose());
  };
  add(joint.mass_kg, centre - new_centre);
  add(mass_kg, at - new_centre);
  Joint<double> heavier = joint;
  heavier.mass_kg = whole;
  heavier.centre_of_mass_m = to_array<double>(new_centre);
  heavier.inertia_kg_m2 = {inertia(0, 0), inertia(1, 1), inertia(2, 2),
                           inertia(0, 1), inertia(0, 2), inertia(1, 2)};
  return heavier;
}

void expect_same_dynamics(const Chain<3, double>& one, const Chain<3, double>& other,
                          std::mt19937_64& generator) {
  ASSERT_EQ(validate(one), Status::kOk);
  ASSERT_EQ(validate(other), Status::kOk);
  const auto a = make_model(one);
  const auto b = make_model(other);
  const auto q = random_vector<3, double>(generator, std::numbers::pi);
  const auto dq = random_vector<3, double>(generator, 2.0);
  const auto ddq = random_vector<3, double>(generator, 2.0);
  EXPECT_LE(deviation(mass_matrix(a, q), mass_matrix(b, q)), 1e-12);
  EXPECT_LE(deviation(inverse_dynamics(a, q, dq, ddq, 0.0), inverse_dynamics(b, q, dq, ddq, 0.0)),
            1e-12);
}

TEST(TipPayload, EqualsAChainWithThatMassInItsLink) {
  std::mt19937_64 generator = seeded_generator();
  for (int sample = 0; sample < 300; ++sample) {
    const Chain<3, double> bare = random_chain<3, double>(generator);
    const auto joint = static_cast<std::uint8_t>(sample % 3);
    const double mass = uniform(generator, -0.4, 3);
    const Eigen::Vector3d at = random_vector3(generator, 0.4);
    Chain<3, double> with_effect = bare;
    ASSERT_TRUE(
        with_effect.effects.add({EffectKind::kTipPayload, joint, {mass, at.x(), at.y(), at.z()}}));
    Chain<3, double> folded = bare;
    folded.joints[joint] = with_mass(bare.joints[joint], mass, at);
    if (validate(folded) != Status::kOk) continue;  // more mass taken than a body can lose there
    expect_same_dynamics(with_effect, folded, generator);
  }
}

TEST(LinkMass, EqualsAChainWithThatMassInItsLink) {
  std::mt19937_64 generator = seeded_generator();
  for (int sample = 0; sample < 300; ++sample) {
    const Chain<3, double> bare = random_chain<3, double>(generator);
    const auto joint = static_cast<std::uint8_t>(sample % 3);
    const double mass = uniform(generator, -0.4, 3);
    Chain<3, double> with_effect = bare;
    ASSERT_TRUE(with_effect.effects.add({EffectKind::kLinkMass, joint, {mass}}));
    Chain<3, double> folded = bare;
    folded.joints[joint].mass_kg += mass;
    expect_same_dynamics(with_effect, folded, generator);
  }
}

TEST(RotorInertia, StandsOnTheDiagonalAndNowhereElse) {
  std::mt19937_64 generator = seeded_generator();
  for (int sample = 0; sample < 100; ++sample) {
    Chain<3, double> chain = random_chain<3, double>(generator);
    const auto bare = make_model(chain);
    const Vector<3, double> rotor(uniform(generator, 0, 2), 0, uniform(generator, 0, 2));
    ASSERT_TRUE(chain.effects.add({EffectKind::kRotorInertia, 0, {rotor[0]}}));
    ASSERT_TRUE(chain.effects.add({EffectKind::kRotorInertia, 2, {rotor[2] / 2}}));
    ASSERT_TRUE(chain.effects.add({EffectKind::kRotorInertia, 2, {rotor[2] / 2}}));
    const auto model = make_model(chain);
    const auto q = random_vector<3, double>(generator, std::numbers::pi);
    const auto dq = random_vector<3, double>(generator, 2.0);
    const auto ddq = random_vector<3, double>(generator, 2.0);
    const Matrix<3, 3, double> expected_m =
        mass_matrix(bare, q) + Matrix<3, 3, double>(rotor.asDiagonal());
    EXPECT_LE(deviation(mass_matrix(model, q), expected_m), 1e-14);
    const Vector<3, double> expected =
        inverse_dynamics(bare, q, dq, ddq, 0.0) + rotor.cwiseProduct(ddq);
    EXPECT_LE(deviation(inverse_dynamics(model, q, dq, ddq, 0.0), expected), 1e-13);
    EXPECT_EQ(bias_torque(model, q, dq, 0.0), bias_torque(bare, q, dq, 0.0));
  }
}

TEST(InertialEffects, AreTakenUpByTheModelAndCostNoTorqueEffect) {
  Chain<1, double> chain;
  ASSERT_TRUE(chain.effects.add({EffectKind::kRotorInertia, 0, {0.1}}));
  ASSERT_TRUE(chain.effects.add({EffectKind::kTipPayload, 0, {0.1, 0.2, 0, 0}}));
  ASSERT_TRUE(chain.effects.add({EffectKind::kLinkMass, 0, {0.1}}));
  ASSERT_TRUE(chain.effects.add({EffectKind::kTorqueOffset, 0, {0.1}}));
  EXPECT_EQ(make_model(chain).torque_effects.view().size(), 1U);
}

}  // namespace
}  // namespace offnominal::test
