#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <offnominal/control/computed_torque.hpp>
#include <offnominal/model/forward_dynamics.hpp>

#include "core/model/random_chain.hpp"
#include "core/print_status.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

using Gains = ComputedTorqueGains<2, double>;

Chain<2, double> chain_with_friction(std::mt19937_64& generator) {
  Chain<2, double> chain = random_chain<2, double>(generator);
  EXPECT_TRUE(chain.effects.add({EffectKind::kViscousFriction, 0, {0.7}}));
  EXPECT_TRUE(chain.effects.add({EffectKind::kCoulombFriction, 1, {0.5, 0.1}}));
  EXPECT_TRUE(chain.effects.add({EffectKind::kPeriodicDisturbance, 1, {0.3, 0.2, 5}}));
  return chain;
}

Reference<2, double> random_reference(std::mt19937_64& generator) {
  return {random_vector<2, double>(generator, 2), random_vector<2, double>(generator, 2),
          random_vector<2, double>(generator, 2)};
}

TEST(ComputedTorque, IsEquation29) {
  std::mt19937_64 generator = seeded_generator();
  for (int sample = 0; sample < 200; ++sample) {
    const auto model = make_model(chain_with_friction(generator));
    const Gains gains{{uniform(generator, 0, 50), uniform(generator, 0, 50)},
                      {uniform(generator, 0, 10), uniform(generator, 0, 10)}};
    const auto reference = random_reference(generator);
    const auto q = random_vector<2, double>(generator, 2);
    const auto dq = random_vector<2, double>(generator, 2);
    const Eigen::Vector2d kp(gains.kp[0], gains.kp[1]);
    const Eigen::Vector2d kd(gains.kd[0], gains.kd[1]);
    const Eigen::Vector2d wanted =
        reference.ddq + kd.asDiagonal() * (reference.dq - dq) + kp.asDiagonal() * (reference.q - q);
    const Eigen::Vector2d expected =
        mass_matrix(model, q) * wanted + bias_torque(model, q, dq, 0.4);
    EXPECT_LE(deviation(computed_torque(model, gains, reference, q, dq, 0.4), expected), 1e-12);
  }
}

// The loop that it closes: ddq - ddq_d = K_d (dq_d - dq) + K_p (q_d - q), the same in every
// posture.
TEST(ComputedTorque, MakesTheErrorLinearAndDecoupled) {
  std::mt19937_64 generator = seeded_generator();
  const Gains gains{{25, 16}, {10, 8}};
  for (int sample = 0; sample < 200; ++sample) {
    const auto model = make_model(chain_with_friction(generator));
    const auto reference = random_reference(generator);
    const auto q = random_vector<2, double>(generator, 2);
    const auto dq = random_vector<2, double>(generator, 2);
    const Eigen::Vector2d tau = computed_torque(model, gains, reference, q, dq, 0.4);
    ForwardDynamics<2, double> forward;
    ASSERT_EQ(forward_dynamics(model, q, dq, tau, 0.4, forward), Status::kOk);
    for (Eigen::Index i = 0; i < 2; ++i) {
      const auto joint = static_cast<std::size_t>(i);
      const double expected = reference.ddq[i] + gains.kd[joint] * (reference.dq[i] - dq[i]) +
                              gains.kp[joint] * (reference.q[i] - q[i]);
      EXPECT_NEAR(forward.ddq[i], expected, 1e-9 * (1 + forward.ddq.norm()));
    }
  }
}

TEST(ComputedTorqueGains, EachBadGainIsRefused) {
  EXPECT_EQ(validate(Gains{}), Status::kOk);
  EXPECT_EQ(validate(Gains{{1, 2}, {3, 4}}), Status::kOk);
  const double infinity = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t joint = 0; joint < 2; ++joint) {
    for (const double bad : {-1.0, infinity, -infinity, nan}) {
      Gains gains{{1, 2}, {3, 4}};
      gains.kp[joint] = bad;
      EXPECT_EQ(validate(gains), Status::kInvalidGain) << bad;
      gains = {{1, 2}, {3, 4}};
      gains.kd[joint] = bad;
      EXPECT_EQ(validate(gains), Status::kInvalidGain) << bad;
    }
  }
}

}  // namespace
}  // namespace offnominal::test
