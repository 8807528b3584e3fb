#include <gtest/gtest.h>

#include <numbers>
#include <offnominal/model/forward_dynamics.hpp>
#include <offnominal/model/momentum.hpp>

#include "core/model/random_chain.hpp"
#include "core/print_status.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

template <int N>
RigidBodyModel<N, double> model_with_rotors(std::mt19937_64& generator) {
  Chain<N, double> chain = random_chain<N, double>(generator);
  for (int i = 0; i < N; ++i) {
    const auto joint = static_cast<std::uint8_t>(i);
    EXPECT_TRUE(chain.effects.add({EffectKind::kRotorInertia, joint, {0.3}, i % 2 == 1}));
    EXPECT_TRUE(chain.effects.add({EffectKind::kViscousFriction, joint, {0.7}}));
  }
  for (double& entry : chain.transmission.motor_per_joint) entry = uniform(generator, -2, 2);
  EXPECT_EQ(validate(chain), Status::kOk);
  return make_model(chain);
}

template <int N>
double kinetic_energy(const RigidBodyModel<N, double>& model, const Vector<N, double>& q,
                      const Vector<N, double>& dq) {
  return 0.5 * dq.dot(mass_matrix<N, double>(model, q) * dq);
}

// dT/dq by central differences of the mass matrix.
template <int N>
Vector<N, double> energy_slope(const RigidBodyModel<N, double>& model, const Vector<N, double>& q,
                               const Vector<N, double>& dq) {
  constexpr double kStep = 1e-5;
  Vector<N, double> slope;
  for (Eigen::Index i = 0; i < N; ++i) {
    Vector<N, double> above = q;
    Vector<N, double> below = q;
    above[i] += kStep;
    below[i] -= kStep;
    slope[i] = (kinetic_energy(model, above, dq) - kinetic_energy(model, below, dq)) / (2 * kStep);
  }
  return slope;
}

template <int N>
void compare_with_mass_matrix(std::mt19937_64& generator) {
  for (int sample = 0; sample < 30; ++sample) {
    const RigidBodyModel<N, double> model = model_with_rotors<N>(generator);
    const auto q = random_vector<N, double>(generator, std::numbers::pi);
    const auto dq = random_vector<N, double>(generator, 3.0);
    const Vector<N, double> rest = Vector<N, double>::Zero();
    const JointTransforms<N, double> at = joint_transforms(model, q);
    const MomentumForm<N, double> form = momentum_form(model, at, dq);
    const Vector<N, double> momentum = mass_matrix(model, at) * dq;
    EXPECT_LE((form.momentum - momentum).norm(), 1e-12 * (1 + momentum.norm()));
    const Vector<N, double> pull = energy_slope(model, q, dq) - rigid_body_bias(model, at, rest);
    EXPECT_LE((form.pull - pull).norm(), 1e-7 * (1 + pull.norm())) << N << " joints";
  }
}

TEST(MomentumForm, IsTheMassMatrixTimesTheVelocityAndTheSlopeOfTheEnergyLessTheWeight) {
  std::mt19937_64 generator = seeded_generator();
  compare_with_mass_matrix<1>(generator);
  compare_with_mass_matrix<2>(generator);
  compare_with_mass_matrix<7>(generator);
}

// The two forms of the same equation of motion: p' along the motion that f says.
TEST(MomentumDynamics, HasTheRateThatTheAccelerationOfForwardDynamicsGives) {
  constexpr int kJoints = 6;
  constexpr double kStep = 1e-5;
  using Joints = Vector<kJoints, double>;
  std::mt19937_64 generator = seeded_generator();
  for (int sample = 0; sample < 30; ++sample) {
    const auto model = model_with_rotors<kJoints>(generator);
    const Joints q = random_vector<kJoints, double>(generator, std::numbers::pi);
    const Joints dq = random_vector<kJoints, double>(generator, 2.0);
    const Joints tau = random_vector<kJoints, double>(generator, 30.0);
    ForwardDynamics<kJoints, double> forward;
    ASSERT_EQ(forward_dynamics(model, q, dq, tau, 0.0, forward), Status::kOk);
    const auto here = momentum_dynamics(model, q, dq, tau, 0.0);
    const auto momentum_at = [&](double t) -> Joints {
      const Joints then = q + t * dq + t * t / 2 * forward.ddq;
      const Joints speed = dq + t * forward.ddq;
      return momentum_dynamics(model, then, speed, tau, 0.0).momentum;
    };
    const Joints rate = (momentum_at(kStep) - momentum_at(-kStep)) / (2 * kStep);
    EXPECT_LE((rate - here.rate).norm(), 1e-6 * (1 + rate.norm() + forward.ddq.norm()));
    EXPECT_EQ(here.told_per_load, forward.told_per_load);
  }
}

}  // namespace
}  // namespace offnominal::test
