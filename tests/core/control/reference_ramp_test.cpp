#include <gtest/gtest.h>

#include <cmath>
#include <offnominal/control/arming.hpp>
#include <offnominal/control/reference_ramp.hpp>

namespace offnominal {
namespace {

constexpr double kRamp = 0.8;

// Of a reference that stays at 0.
Reference<2, double> ramped(double time_s) {
  ReferenceRamp<2, double> ramp;
  ramp.q << 0.05, -0.02;
  ramp.dq << -0.3, 0.1;
  Reference<2, double> reference;
  ramp_in(ramp, time_s, kRamp, reference);
  return reference;
}

TEST(ReferenceRamp, BeginsWithTheArmAndEndsWithTheReference) {
  const auto begin = ramped(0);
  EXPECT_NEAR(begin.q[0], -0.05, 1e-15);
  EXPECT_NEAR(begin.dq[0], 0.3, 1e-15);
  EXPECT_NEAR(begin.ddq[0], 0, 1e-15);
  EXPECT_NEAR(begin.q[1], 0.02, 1e-15);
  for (const double after : {kRamp - 1e-9, kRamp, 100.0}) {
    const auto end = ramped(after);
    EXPECT_LT(end.q.norm() + end.dq.norm() + end.ddq.norm(), 1e-6) << after;
  }
  EXPECT_EQ(ramped(kRamp).q.norm(), 0.0);
}

TEST(ReferenceRamp, VelocityAndAccelerationAreItsDerivatives) {
  constexpr double kStep = 1e-6;
  for (double time_s = 0.01; time_s < kRamp - 0.01; time_s += 0.013) {
    const auto before = ramped(time_s - kStep);
    const auto now = ramped(time_s);
    const auto after = ramped(time_s + kStep);
    EXPECT_LT(((after.q - before.q) / (2 * kStep) - now.dq).norm(), 1e-8) << time_s;
    EXPECT_LT(((after.dq - before.dq) / (2 * kStep) - now.ddq).norm(), 1e-6) << time_s;
  }
}

TEST(ReferenceRamp, FadesWithoutOvershoot) {
  ReferenceRamp<1, double> ramp;
  ramp.q[0] = 1;
  double last = -1;
  for (double time_s = 0; time_s <= kRamp; time_s += 0.01) {
    Reference<1, double> reference;
    ramp_in(ramp, time_s, kRamp, reference);
    EXPECT_GE(reference.q[0], last - 1e-12) << time_s;
    EXPECT_LE(reference.q[0], 1e-12) << time_s;
    EXPECT_LT(std::fabs(reference.dq[0]), 1.9 / kRamp);
    last = reference.q[0];
  }
}

TEST(DefaultArming, IsSafeAndUsable) {
  Chain<2, float> chain;
  chain.joints[0].max_torque = 50;
  chain.joints[1].type = JointType::kPrismatic;
  const auto arming = default_arming(chain);
  EXPECT_EQ(validate(arming), Status::kOk) << "a joint without a limit too";
  EXPECT_FLOAT_EQ(arming.torque_rate[0], 1000);
  EXPECT_FLOAT_EQ(arming.position_window[0], 0.05F);
  EXPECT_FLOAT_EQ(arming.position_window[1], 0.01F);
  EXPECT_FLOAT_EQ(arming.speed[1], 0.01F);
  EXPECT_EQ(validate(ArmingConfig<2, float>{}), Status::kInvalidLimit);
}

}  // namespace
}  // namespace offnominal
