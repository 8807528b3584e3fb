#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <offnominal/model/forward_dynamics.hpp>

#include "core/model/random_chain.hpp"
#include "core/print_status.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

template <typename Scalar>
constexpr Scalar kNotANumber = std::numeric_limits<Scalar>::quiet_NaN();

template <int N, typename Scalar>
void add_some_friction(Chain<N, Scalar>& chain) {
  for (int i = 0; i < N; ++i) {
    const auto joint = static_cast<std::uint8_t>(i);
    ASSERT_TRUE(chain.effects.add({EffectKind::kViscousFriction, joint, {Scalar(0.7)}}));
    ASSERT_TRUE(
        chain.effects.add({EffectKind::kCoulombFriction, joint, {Scalar(0.4), Scalar(0.1)}}));
  }
}

// Relative to the torque that went in: acceleration -> torque -> acceleration -> torque.
template <int N, typename Scalar>
double worst_round_trip(std::mt19937_64& generator, int chains) {
  double worst = 0;
  for (int sample = 0; sample < chains; ++sample) {
    Chain<N, Scalar> chain = random_chain<N, Scalar>(generator);
    add_some_friction(chain);
    const auto model = make_model(chain);
    const auto q = random_vector<N, Scalar>(generator, std::numbers::pi);
    const auto dq = random_vector<N, Scalar>(generator, 2.0);
    const auto tau = random_vector<N, Scalar>(generator, 50.0);
    ForwardDynamics<N, Scalar> forward;
    EXPECT_EQ(forward_dynamics(model, q, dq, tau, 1.0, forward), Status::kOk);
    EXPECT_EQ(forward.inertia, mass_matrix(model, q));
    worst = std::max(worst, deviation(inverse_dynamics(model, q, dq, forward.ddq, 1.0), tau));
  }
  return worst;
}

TEST(ForwardDynamics, InverseOfForwardGivesTheTorqueBack) {
  std::mt19937_64 generator = seeded_generator();
  EXPECT_LE((worst_round_trip<2, double>(generator, 300)), 1e-10);
  EXPECT_LE((worst_round_trip<7, double>(generator, 300)), 1e-10);
  EXPECT_LE((worst_round_trip<2, float>(generator, 300)), 1e-3);
#ifndef OFFNOMINAL_SANITIZE  // the same code in other sizes
  EXPECT_LE((worst_round_trip<1, double>(generator, 300)), 1e-10);
  EXPECT_LE((worst_round_trip<6, double>(generator, 300)), 1e-10);
  EXPECT_LE((worst_round_trip<6, float>(generator, 300)), 1e-3);
#endif
}

TEST(ForwardDynamics, GivenAMassOnItsOwnAxisThenTheMassMatrixIsReportedSingular) {
  Chain<1, double> chain;
  ASSERT_EQ(validate(chain), Status::kOk);
  const auto model = make_model(chain);
  const Vector<1, double> zero = Vector<1, double>::Zero();
  ForwardDynamics<1, double> result;
  result.ddq[0] = 12;
  result.inertia(0, 0) = 34;
  EXPECT_EQ(forward_dynamics(model, zero, zero, zero, 0.0, result), Status::kSingularMassMatrix);
  EXPECT_EQ(result.ddq[0], 12);
  EXPECT_EQ(result.inertia(0, 0), 34);
}

TEST(ForwardDynamics, GivenMoreMassTakenAwayThanThereIsThenTheMassMatrixIsReportedSingular) {
  std::mt19937_64 generator = seeded_generator();
  Chain<2, double> chain = random_chain<2, double>(generator);
  chain.joints[1].type = JointType::kPrismatic;
  ASSERT_TRUE(chain.effects.add({EffectKind::kLinkMass, 1, {-2 * chain.joints[1].mass_kg}}));
  const auto model = make_model(chain);
  const Vector<2, double> zero = Vector<2, double>::Zero();
  ForwardDynamics<2, double> result;
  EXPECT_EQ(forward_dynamics(model, zero, zero, zero, 0.0, result), Status::kSingularMassMatrix);
}

template <typename Scalar>
void expect_refused(const RigidBodyModel<2, Scalar>& model, const Vector<2, Scalar>& q,
                    const Vector<2, Scalar>& dq, const Vector<2, Scalar>& tau, double time_s) {
  ForwardDynamics<2, Scalar> result;
  result.ddq.setConstant(5);
  result.inertia.setConstant(6);
  EXPECT_EQ(forward_dynamics(model, q, dq, tau, time_s, result), Status::kSingularMassMatrix);
  EXPECT_EQ(result.ddq, (Vector<2, Scalar>::Constant(5)));
  EXPECT_EQ(result.inertia, (Matrix<2, 2, Scalar>::Constant(6)));
}

template <typename Scalar>
void expect_every_nan_refused(std::mt19937_64& generator) {
  Chain<2, Scalar> chain = random_chain<2, Scalar>(generator);
  ASSERT_TRUE(
      chain.effects.add({EffectKind::kPeriodicDisturbance, 0, {Scalar(1), Scalar(1), Scalar(2)}}));
  const auto model = make_model(chain);
  using Vec = Vector<2, Scalar>;
  const Vec good = Vec::Constant(Scalar(0.3));
  for (const Scalar bad : {kNotANumber<Scalar>, std::numeric_limits<Scalar>::infinity()}) {
    for (Eigen::Index joint = 0; joint < 2; ++joint) {
      Vec one_bad = good;
      one_bad[joint] = bad;
      expect_refused(model, one_bad, good, good, 0.0);
      expect_refused(model, good, one_bad, good, 0.0);
      expect_refused(model, good, good, one_bad, 0.0);
    }
    expect_refused(model, good, good, good, static_cast<double>(bad));
  }
}

TEST(ForwardDynamics, GivenANonFiniteInputThenItIsRefusedAndTheResultUntouched) {
  std::mt19937_64 generator = seeded_generator();
  expect_every_nan_refused<double>(generator);
  expect_every_nan_refused<float>(generator);
}

}  // namespace
}  // namespace offnominal::test
