#include "offnominal/sim/hidden/planar_arm.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "offnominal/sim/hidden/draws.hpp"
#include "offnominal/sim/two_link_arm.hpp"
#include "support/seed.hpp"

namespace offnominal::sim::hidden {
namespace {

using Eigen::Vector2d;

Vector2d drawn(Draws& draws, double range) {
  return {draws.uniform(-range, range), draws.uniform(-range, range)};
}

std::array<RigidLink, 2> drawn_links(Draws& draws) {
  std::array<RigidLink, 2> links;
  for (RigidLink& link : links) {
    link = {draws.uniform(1.0, 6.0), draws.uniform(0.3, 0.6), draws.uniform(0.1, 0.3),
            draws.uniform(0.01, 0.2)};
  }
  return links;
}

// The point-mass arm of the paper is another closed form: masses at the ends, no inertia.
TEST(PlanarArm, AgreesWithTheArmOfPointMasses) {
  Draws draws(offnominal::test::test_seed(), Stream::kArm);
  for (int i = 0; i < 100; ++i) {
    std::array<RigidLink, 2> links = drawn_links(draws);
    for (RigidLink& link : links) {
      link.centre_of_mass_m = link.length_m;
      link.inertia_kg_m2 = 0.0;
    }
    const double tip_kg = draws.uniform(0.0, 2.0);
    const PlanarArm arm(links, 9.81, tip_kg);
    const TwoLinkParameters points{links[0].mass_kg, links[1].mass_kg + tip_kg, links[0].length_m,
                                   links[1].length_m, 9.81};
    const Vector2d q = drawn(draws, 3.0), dq = drawn(draws, 4.0), ddq = drawn(draws, 9.0);
    const Vector2d oracle =
        mass_matrix(points, q) * ddq + velocity_torque(points, {q, dq}) + gravity_torque(points, q);
    EXPECT_LT((arm.torque(q, dq, ddq) - oracle).norm(), 1e-11 * (1.0 + oracle.norm()));
  }
}

// A rigid link is two half masses at its radius of gyration from the centre of mass.
double energy_of_points(const std::array<RigidLink, 2>& links, const Vector2d& q,
                        const Vector2d& dq) {
  const double a12 = q[0] + q[1], w12 = dq[0] + dq[1];
  double energy = 0.0;
  for (std::size_t i = 0; i < 2; ++i) {
    const RigidLink& link = links[i];
    const double gyration = std::sqrt(link.inertia_kg_m2 / link.mass_kg);
    const double elbow = i == 0 ? 0.0 : links[0].length_m;
    for (const double r : {link.centre_of_mass_m - gyration, link.centre_of_mass_m + gyration}) {
      const double a = i == 0 ? q[0] : a12, w = i == 0 ? dq[0] : w12;
      const Vector2d velocity(-elbow * dq[0] * std::sin(q[0]) - r * w * std::sin(a),
                              elbow * dq[0] * std::cos(q[0]) + r * w * std::cos(a));
      const double height = elbow * std::sin(q[0]) + r * std::sin(a);
      energy += 0.5 * link.mass_kg * (0.5 * velocity.squaredNorm() + 9.81 * height);
    }
  }
  return energy;
}

TEST(PlanarArm, DistributedMassHasTheEnergyOfItsPoints) {
  Draws draws(offnominal::test::test_seed(), Stream::kArm);
  for (int i = 0; i < 100; ++i) {
    const std::array<RigidLink, 2> links = drawn_links(draws);
    const Vector2d q = drawn(draws, 3.0), dq = drawn(draws, 4.0);
    EXPECT_NEAR(PlanarArm(links, 9.81).energy(q, dq), energy_of_points(links, q, dq), 1e-10);
  }
}

TEST(PlanarArm, PowerOfTheJointsIsTheRiseOfEnergy) {
  Draws draws(offnominal::test::test_seed(), Stream::kArm);
  for (int i = 0; i < 100; ++i) {
    const PlanarArm arm(drawn_links(draws), 9.81, draws.uniform(0.0, 2.0));
    const Vector2d q = drawn(draws, 3.0), dq = drawn(draws, 4.0), ddq = drawn(draws, 9.0);
    const double h = 1e-5;
    const double after = arm.energy(q + h * dq + 0.5 * h * h * ddq, dq + h * ddq);
    const double before = arm.energy(q - h * dq + 0.5 * h * h * ddq, dq - h * ddq);
    const double power = arm.torque(q, dq, ddq).dot(dq);
    EXPECT_NEAR((after - before) / (2.0 * h), power, 1e-5 * (1.0 + std::abs(power)));
  }
}

TEST(PlanarArm, MassMatrixIsPositiveDefinite) {
  Draws draws(offnominal::test::test_seed(), Stream::kArm);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Matrix2d m =
        PlanarArm(drawn_links(draws), 9.81).terms(drawn(draws, 3.0), Vector2d::Zero()).mass;
    EXPECT_EQ(m(0, 1), m(1, 0));
    EXPECT_GT(m(0, 0), 0.0);
    EXPECT_GT(m.determinant(), 0.0);
  }
}

}  // namespace
}  // namespace offnominal::sim::hidden
