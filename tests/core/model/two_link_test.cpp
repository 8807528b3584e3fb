#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <offnominal/model/forward_dynamics.hpp>

#include "core/model/random_chain.hpp"
#include "core/model/two_link_closed_form.hpp"
#include "core/print_status.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

template <typename Scalar>
Chain<2, Scalar> two_link_chain(const TwoLinkClosedForm& arm) {
  Chain<2, Scalar> chain;
  chain.gravity_m_s2 = {0, static_cast<Scalar>(-arm.gravity), 0};
  chain.joints[0].mass_kg = static_cast<Scalar>(arm.mass1);
  chain.joints[0].centre_of_mass_m = {static_cast<Scalar>(arm.length1), 0, 0};
  chain.joints[1].origin_m = {static_cast<Scalar>(arm.length1), 0, 0};
  chain.joints[1].mass_kg = static_cast<Scalar>(arm.mass2);
  chain.joints[1].centre_of_mass_m = {static_cast<Scalar>(arm.length2), 0, 0};
  return chain;
}

// The numbers as the chain holds them, so that only the arithmetic is compared.
template <typename Scalar>
TwoLinkClosedForm rounded_to(const TwoLinkClosedForm& arm) {
  const auto rounded = [](double value) { return static_cast<double>(static_cast<Scalar>(value)); };
  return {rounded(arm.mass1), rounded(arm.mass2), rounded(arm.length1), rounded(arm.length2),
          rounded(arm.gravity)};
}

struct Worst {
  double inertia = 0;
  double bias = 0;
  double torque = 0;
  double acceleration = 0;
};

template <typename Scalar>
Worst worst_against_closed_form(std::mt19937_64& generator) {
  const TwoLinkClosedForm arm = rounded_to<Scalar>(TwoLinkClosedForm{});
  const Chain<2, Scalar> chain = two_link_chain<Scalar>(arm);
  EXPECT_EQ(validate(chain), Status::kOk);
  const RigidBodyModel<2, Scalar> model = make_model(chain);
  Worst worst;
  for (int sample = 0; sample < 2000; ++sample) {
    const auto q = random_vector<2, Scalar>(generator, std::numbers::pi);
    const auto dq = random_vector<2, Scalar>(generator, 3.0);
    const auto ddq = random_vector<2, Scalar>(generator, 3.0);
    const auto tau = random_vector<2, Scalar>(generator, 10.0);
    const Eigen::Vector2d& q_exact = q.template cast<double>();
    const Eigen::Vector2d& dq_exact = dq.template cast<double>();
    ForwardDynamics<2, Scalar> forward;
    EXPECT_EQ(forward_dynamics(model, q, dq, tau, 0.0, forward), Status::kOk);
    const auto keep = [](double& largest, double value) { largest = std::max(largest, value); };
    keep(worst.inertia, deviation(mass_matrix(model, q), arm.inertia(q_exact)));
    keep(worst.inertia, deviation(forward.inertia, arm.inertia(q_exact)));
    keep(worst.bias, deviation(bias_torque(model, q, dq, 0.0), arm.bias(q_exact, dq_exact)));
    keep(worst.torque, deviation(inverse_dynamics(model, q, dq, ddq, 0.0),
                                 arm.torque(q_exact, dq_exact, ddq.template cast<double>())));
    keep(worst.acceleration,
         deviation(forward.ddq, arm.acceleration(q_exact, dq_exact, tau.template cast<double>())));
  }
  return worst;
}

TEST(TwoLinkArm, AgreesWithItsClosedFormInDouble) {
  std::mt19937_64 generator = seeded_generator();
  const Worst worst = worst_against_closed_form<double>(generator);
  EXPECT_LE(worst.inertia, 1e-12);
  EXPECT_LE(worst.bias, 1e-12);
  EXPECT_LE(worst.torque, 1e-12);
  EXPECT_LE(worst.acceleration, 1e-12);
}

// Each result is a sum of a few dozen products of float numbers, at most the size of the largest
// torque: 32 roundings of it. The acceleration is that error times the condition number of M, below
// 60 for these lengths and masses.
TEST(TwoLinkArm, AgreesWithItsClosedFormInFloat) {
  std::mt19937_64 generator = seeded_generator();
  const Worst worst = worst_against_closed_form<float>(generator);
  const auto rounding = static_cast<double>(std::numeric_limits<float>::epsilon());
  EXPECT_LE(worst.inertia, 32 * rounding);
  EXPECT_LE(worst.bias, 32 * rounding);
  EXPECT_LE(worst.torque, 32 * rounding);
  EXPECT_LE(worst.acceleration, 60 * 32 * rounding);
}

TEST(TwoLinkArm, StretchedOutHorizontallyItsJointsCarryTheWholeWeight) {
  const TwoLinkClosedForm arm;
  const RigidBodyModel<2, double> model = make_model(two_link_chain<double>(arm));
  const Eigen::Vector2d rest = Eigen::Vector2d::Zero();
  const Eigen::Vector2d tau = bias_torque(model, rest, rest, 0.0);
  const double outer = arm.mass2 * 9.81 * (arm.length1 + arm.length2);
  EXPECT_NEAR(tau[0], arm.mass1 * 9.81 * arm.length1 + outer, 1e-12);
  EXPECT_NEAR(tau[1], arm.mass2 * 9.81 * arm.length2, 1e-12);
}

}  // namespace
}  // namespace offnominal::test
