#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <offnominal/model/forward_dynamics.hpp>

#include "core/model/random_chain.hpp"
#include "core/print_status.hpp"
#include "support/repetitions.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

template <int N>
struct Motion {
  Vector<N, double> q;
  Vector<N, double> dq;
};

template <int N>
Vector<N, double> free_acceleration(const RigidBodyModel<N, double>& model,
                                    const Vector<N, double>& q, const Vector<N, double>& dq) {
  ForwardDynamics<N, double> result;
  const Vector<N, double> no_torque = Vector<N, double>::Zero();
  EXPECT_EQ(forward_dynamics(model, q, dq, no_torque, 0.0, result), Status::kOk);
  return result.ddq;
}

// Classical Runge-Kutta, order 4.
template <int N>
Motion<N> moved(const RigidBodyModel<N, double>& model, const Motion<N>& at, double step_s) {
  using Vec = Vector<N, double>;
  const double half = step_s / 2;
  const Vec a1 = free_acceleration(model, at.q, at.dq);
  const Vec v2 = at.dq + half * a1;
  const Vec a2 = free_acceleration<N>(model, at.q + half * at.dq, v2);
  const Vec v3 = at.dq + half * a2;
  const Vec a3 = free_acceleration<N>(model, at.q + half * v2, v3);
  const Vec v4 = at.dq + step_s * a3;
  const Vec a4 = free_acceleration<N>(model, at.q + step_s * v3, v4);
  return {at.q + step_s / 6 * (at.dq + 2 * v2 + 2 * v3 + v4),
          at.dq + step_s / 6 * (a1 + 2 * a2 + 2 * a3 + a4)};
}

// By the heights of the centres of mass, placed by rotations of Eigen's own.
template <int N>
double potential_energy(const Chain<N, double>& chain, const Vector<N, double>& q) {
  const Eigen::Vector3d gravity(chain.gravity_m_s2.data());
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  double energy = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(N); ++i) {
    const Joint<double>& joint = chain.joints[i];
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rotation(joint.rotation.data());
    const Eigen::Vector3d axis(joint.axis.data());
    const double qi = q[static_cast<Eigen::Index>(i)];
    frame.translate(Eigen::Vector3d(joint.origin_m.data()));
    frame.rotate(Eigen::Quaterniond(Eigen::Matrix3d(rotation)));
    if (joint.type == JointType::kRevolute) {
      frame.rotate(Eigen::AngleAxisd(qi, axis));
    } else {
      frame.translate(qi * axis);
    }
    const Eigen::Vector3d centre = frame * Eigen::Vector3d(joint.centre_of_mass_m.data());
    energy -= joint.mass_kg * gravity.dot(centre);
  }
  return energy;
}

template <int N>
double kinetic_energy(const RigidBodyModel<N, double>& model, const Motion<N>& at) {
  return at.dq.dot(mass_matrix(model, at.q) * at.dq) / 2;
}

struct EnergyRun {
  double drift = 0;    // largest |energy - energy at the start|
  double kinetic = 0;  // largest kinetic energy
  double last = 0;     // energy at the end minus energy at the start
  double largest_rise = 0;
};

template <int N>
EnergyRun run_freely(const Chain<N, double>& chain, Motion<N> at, double step_s, int steps) {
  const auto model = make_model(chain);
  const auto energy = [&](const Motion<N>& motion) {
    return kinetic_energy(model, motion) + potential_energy(chain, motion.q);
  };
  const double start = energy(at);
  double before = start;
  EnergyRun run;
  for (int step = 0; step < steps; ++step) {
    at = moved(model, at, step_s);
    const double now = energy(at);
    run.drift = std::max(run.drift, std::fabs(now - start));
    run.kinetic = std::max(run.kinetic, kinetic_energy(model, at));
    run.largest_rise = std::max(run.largest_rise, now - before);
    before = now;
    run.last = now - start;
  }
  return run;
}

// A brisk start in either direction, so that there is energy to lose.
template <int N>
Motion<N> random_start(std::mt19937_64& generator) {
  Motion<N> start{random_vector<N, double>(generator, 1.0), Vector<N, double>::Zero()};
  for (double& velocity : start.dq) {
    velocity = std::copysign(uniform(generator, 1, 2), uniform(generator, -1, 1));
  }
  return start;
}

// Some of the random chains whirl: the step is halved until the integrator's own error is out of
// the way, which it never is when the model loses energy.
template <int N>
void expect_energy_conserved(std::mt19937_64& generator) {
  Chain<N, double> chain = random_chain<N, double>(generator);
  chain.joints[0].type = JointType::kRevolute;
  if (N > 1) chain.joints[N - 1].type = JointType::kPrismatic;
  const Motion<N> start = random_start<N>(generator);
  double step_s = 2e-4;
  double relative_drift = 1;
  const int most = repetitions(1600000);
  for (int steps = repetitions(50000); steps <= most && relative_drift > 1e-8; steps *= 2) {
    const EnergyRun run = run_freely(chain, start, step_s, steps);
    EXPECT_GT(run.kinetic, 1e-3);
    relative_drift = run.drift / run.kinetic;
    step_s /= 2;
  }
  EXPECT_LE(relative_drift, 1e-8);
}

TEST(Energy, IsConservedOverTenSecondsWithoutFriction) {
  std::mt19937_64 generator = seeded_generator();
  expect_energy_conserved<1>(generator);
  expect_energy_conserved<2>(generator);
  expect_energy_conserved<3>(generator);
}

TEST(Energy, FallsAndNeverRisesUnderEveryFriction) {
  std::mt19937_64 generator = seeded_generator();
  const std::array<Effect<double>, 5> frictions{{
      {EffectKind::kViscousFriction, 0, {0.5}},
      {EffectKind::kCoulombFriction, 0, {0.5, 0.05}},
      {EffectKind::kStribeckFriction, 0, {0.5, 0.8, 0.05}},
      {EffectKind::kQuadraticFriction, 0, {0.5}},
      {EffectKind::kTemperatureDrift, 0, {0.5, 0.2, 1.0, 0.05}},
  }};
  for (const Effect<double>& friction : frictions) {
    Chain<2, double> chain = random_chain<2, double>(generator);
    chain.joints[0].type = JointType::kRevolute;
    chain.joints[1].type = JointType::kRevolute;
    ASSERT_TRUE(chain.effects.add(friction));
    Effect<double> at_the_second = friction;
    at_the_second.joint = 1;
    ASSERT_TRUE(chain.effects.add(at_the_second));
    const EnergyRun run = run_freely(chain, random_start<2>(generator), 2e-4, 5000);
    EXPECT_LT(run.last, -1e-3) << info_of(friction.kind)->name;
    EXPECT_LE(run.largest_rise, 1e-8 * std::max(1.0, run.kinetic)) << info_of(friction.kind)->name;
  }
}

}  // namespace
}  // namespace offnominal::test
