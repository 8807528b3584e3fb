// What an effect that depends on time gives after a long one.
#include <gtest/gtest.h>

#include <cmath>
#include <offnominal/model/inverse_dynamics.hpp>

namespace offnominal {
namespace {

// GIVEN a disturbance of 3 rad/s WHEN a year has passed THEN its phase in float is as right as on
// the first day.
TEST(PeriodicDisturbance, KeepsItsPhaseForAYear) {
  Chain<1, float> chain;
  ASSERT_TRUE(chain.effects.add({EffectKind::kPeriodicDisturbance, 0, {2.0F, 0.5F, 3.0F}}));
  const auto model = make_model(chain);
  const Vector<1, float> rest = Vector<1, float>::Zero();
  for (const double begin_s : {0.0, 3600.0, 86'400.0, 365 * 86'400.0}) {
    for (int i = 0; i < 2000; ++i) {
      const double time_s = begin_s + 0.001 * i;
      const double expected = 2 * std::sin(3 * time_s) + 0.5 * std::cos(3 * time_s);
      ASSERT_NEAR(effect_torque(model, rest, rest, time_s)[0], expected, 1e-5) << time_s;
    }
  }
}

TEST(TemperatureDrift, EndsAndStaysEnded) {
  Chain<1, float> chain;
  ASSERT_TRUE(chain.effects.add({EffectKind::kTemperatureDrift, 0, {2.0F, 0.0F, 600.0F, 0.01F}}));
  const auto model = make_model(chain);
  const Vector<1, float> moving = Vector<1, float>::Ones();
  EXPECT_NEAR(effect_torque(model, moving, moving, 600.0)[0], 2 * std::exp(-1.0), 1e-6);
  EXPECT_NEAR(effect_torque(model, moving, moving, 365 * 86'400.0)[0], 0, 1e-30);
}

}  // namespace
}  // namespace offnominal
