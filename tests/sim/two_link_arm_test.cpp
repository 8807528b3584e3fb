#include "offnominal/sim/two_link_arm.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

#include "support/seed.hpp"

namespace offnominal::sim {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

struct RandomArm {
  TwoLinkParameters arm;
  TwoLinkState state;
};

RandomArm random_arm(std::mt19937_64& generator) {
  std::uniform_real_distribution<double> size(0.2, 3.0), angle(-3.0, 3.0), speed(-4.0, 4.0);
  RandomArm random;
  random.arm = {size(generator), size(generator), size(generator), size(generator), 9.81};
  random.state.q = {angle(generator), angle(generator)};
  random.state.dq = {speed(generator), speed(generator)};
  return random;
}

// Kinetic less potential energy straight from the positions of the two masses.
double lagrangian(const TwoLinkParameters& arm, const Vector2d& q, const Vector2d& dq) {
  const double a1 = q[0], a12 = q[0] + q[1], w1 = dq[0], w12 = dq[0] + dq[1];
  const Vector2d p1(arm.length1_m * std::cos(a1), arm.length1_m * std::sin(a1));
  const Vector2d p2 = p1 + arm.length2_m * Vector2d(std::cos(a12), std::sin(a12));
  const Vector2d v1 = arm.length1_m * w1 * Vector2d(-std::sin(a1), std::cos(a1));
  const Vector2d v2 = v1 + arm.length2_m * w12 * Vector2d(-std::sin(a12), std::cos(a12));
  return 0.5 * arm.mass1_kg * v1.squaredNorm() + 0.5 * arm.mass2_kg * v2.squaredNorm() -
         arm.gravity_m_s2 * (arm.mass1_kg * p1.y() + arm.mass2_kg * p2.y());
}

// d/dt dL/ddq - dL/dq by central differences of the Lagrangian, the acceleration being given.
Vector2d euler_lagrange_torque(const TwoLinkParameters& arm, const TwoLinkState& s,
                               const Vector2d& ddq) {
  const double h = 2e-4;
  const auto momentum = [&](const Vector2d& q, const Vector2d& dq) {
    Vector2d p;
    for (int i = 0; i < 2; ++i) {
      const Vector2d d = h * Vector2d::Unit(i);
      p[i] = (lagrangian(arm, q, dq + d) - lagrangian(arm, q, dq - d)) / (2.0 * h);
    }
    return p;
  };
  Vector2d torque = (momentum(s.q + h * s.dq + 0.5 * h * h * ddq, s.dq + h * ddq) -
                     momentum(s.q - h * s.dq + 0.5 * h * h * ddq, s.dq - h * ddq)) /
                    (2.0 * h);
  for (int i = 0; i < 2; ++i) {
    const Vector2d d = h * Vector2d::Unit(i);
    torque[i] -= (lagrangian(arm, s.q + d, s.dq) - lagrangian(arm, s.q - d, s.dq)) / (2.0 * h);
  }
  return torque;
}

TEST(TwoLinkArm, ClosedFormAgreesWithDifferentiatedLagrangian) {
  auto generator = test::seeded_generator();
  std::uniform_real_distribution<double> acceleration(-5.0, 5.0);
  for (int i = 0; i < 200; ++i) {
    const auto [arm, state] = random_arm(generator);
    const Vector2d ddq(acceleration(generator), acceleration(generator));
    const Vector2d closed = mass_matrix(arm, state.q) * ddq + velocity_torque(arm, state) +
                            gravity_torque(arm, state.q);
    const Vector2d numeric = euler_lagrange_torque(arm, state, ddq);
    EXPECT_LT((closed - numeric).norm(), 1e-5 * (1.0 + closed.norm())) << "sample " << i;
  }
}

TEST(TwoLinkArm, ForwardAccelerationInvertsTheTorque) {
  auto generator = test::seeded_generator();
  std::uniform_real_distribution<double> torque(-50.0, 50.0);
  for (int i = 0; i < 200; ++i) {
    const auto [arm, state] = random_arm(generator);
    const Vector2d tau(torque(generator), torque(generator));
    const Vector2d ddq = forward_acceleration(arm, state, tau);
    const Vector2d back = mass_matrix(arm, state.q) * ddq + velocity_torque(arm, state) +
                          gravity_torque(arm, state.q);
    EXPECT_LT((back - tau).norm(), 1e-11 * (1.0 + tau.norm() + ddq.norm())) << "sample " << i;
  }
}

TEST(TwoLinkArm, MassMatrixIsSymmetricAndPositiveDefinite) {
  auto generator = test::seeded_generator();
  for (int i = 0; i < 200; ++i) {
    const auto [arm, state] = random_arm(generator);
    const Matrix2d m = mass_matrix(arm, state.q);
    EXPECT_EQ(m(0, 1), m(1, 0));
    EXPECT_GT(m(0, 0), 0.0);
    EXPECT_GT(m.determinant(), 0.0);
  }
}

TEST(TwoLinkArm, PaperDeterminantIsFiveLessFourCosSquared) {
  for (const double q2 : {-1.3, -0.2, 0.0, 0.23, 2.0}) {
    const double cosine = std::cos(q2);
    EXPECT_NEAR(mass_matrix({}, {0.4, q2}).determinant(), 5.0 - 4.0 * cosine * cosine, 1e-14);
  }
}

TEST(TwoLinkArm, HorizontalPaperArmIsHeldByItsWeightMoments) {
  const Vector2d g = gravity_torque({}, Vector2d::Zero());
  EXPECT_NEAR(g[0], 9.81 * (0.5 * 1.0 + 2.0 * 2.0), 1e-12);
  EXPECT_NEAR(g[1], 9.81 * 2.0 * 1.0, 1e-12);
}

}  // namespace
}  // namespace offnominal::sim
