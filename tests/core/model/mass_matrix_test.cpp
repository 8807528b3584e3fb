#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <limits>
#include <numbers>
#include <offnominal/model/inverse_dynamics.hpp>
#include <offnominal/model/mass_matrix.hpp>

#include "core/model/random_chain.hpp"
#include "core/print_status.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

template <int N, typename Scalar>
void expect_symmetric_positive_definite(std::mt19937_64& generator, int chains) {
  for (int sample = 0; sample < chains; ++sample) {
    const Chain<N, Scalar> chain = random_chain<N, Scalar>(generator);
    ASSERT_EQ(validate(chain), Status::kOk);
    const auto model = make_model(chain);
    const auto q = random_vector<N, Scalar>(generator, std::numbers::pi);
    const Matrix<N, N, Scalar> m = mass_matrix(model, q);
    EXPECT_EQ(m, m.transpose());
    // Of any size: the solver is compiled once, not for every number of joints.
    using AnySize = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
    const Eigen::SelfAdjointEigenSolver<AnySize> eigen(AnySize(m), Eigen::EigenvaluesOnly);
    EXPECT_GT(eigen.eigenvalues().minCoeff(), Scalar(0));
  }
}

TEST(MassMatrix, IsSymmetricPositiveDefiniteOverRandomChains) {
  std::mt19937_64 generator = seeded_generator();
  expect_symmetric_positive_definite<2, double>(generator, 500);
  expect_symmetric_positive_definite<7, double>(generator, 500);
  expect_symmetric_positive_definite<2, float>(generator, 500);
#ifndef OFFNOMINAL_SANITIZE  // the same code in other sizes
  expect_symmetric_positive_definite<1, double>(generator, 500);
  expect_symmetric_positive_definite<6, double>(generator, 500);
  expect_symmetric_positive_definite<6, float>(generator, 500);
#endif
}

// Column j of M is the torque of a unit acceleration of joint j alone, at rest, without gravity.
template <int N, typename Scalar>
double worst_column_against_newton_euler(std::mt19937_64& generator, int chains) {
  double worst = 0;
  for (int sample = 0; sample < chains; ++sample) {
    Chain<N, Scalar> chain = random_chain<N, Scalar>(generator);
    chain.gravity_m_s2 = {0, 0, 0};
    for (int i = 0; i < N; ++i) {
      const auto joint = static_cast<std::uint8_t>(i);
      const auto inertia = static_cast<Scalar>(uniform(generator, 0, 2));
      EXPECT_TRUE(chain.effects.add({EffectKind::kRotorInertia, joint, {inertia}}));
    }
    const auto model = make_model(chain);
    const auto q = random_vector<N, Scalar>(generator, std::numbers::pi);
    const Matrix<N, N, Scalar> m = mass_matrix(model, q);
    const Vector<N, Scalar> rest = Vector<N, Scalar>::Zero();
    Matrix<N, N, Scalar> columns;
    for (Eigen::Index j = 0; j < N; ++j) {
      const Vector<N, Scalar> unit = Vector<N, Scalar>::Unit(j);
      columns.col(j) = inverse_dynamics(model, q, rest, unit, 0.0);
    }
    worst = std::max(worst, deviation(m, columns));
  }
  return worst;
}

TEST(MassMatrix, AgreesWithNewtonEulerColumnByColumn) {
  std::mt19937_64 generator = seeded_generator();
  EXPECT_LE((worst_column_against_newton_euler<2, double>(generator, 200)), 1e-13);
#ifndef OFFNOMINAL_SANITIZE  // the same code in other sizes
  EXPECT_LE((worst_column_against_newton_euler<1, double>(generator, 200)), 1e-13);
  EXPECT_LE((worst_column_against_newton_euler<6, double>(generator, 200)), 1e-13);
#endif
  EXPECT_LE((worst_column_against_newton_euler<7, double>(generator, 200)), 1e-13);
  const double float_tolerance = 64 * static_cast<double>(std::numeric_limits<float>::epsilon());
  EXPECT_LE((worst_column_against_newton_euler<2, float>(generator, 200)), float_tolerance);
  EXPECT_LE((worst_column_against_newton_euler<7, float>(generator, 200)), float_tolerance);
}

}  // namespace
}  // namespace offnominal::test
