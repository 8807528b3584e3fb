// Samples that are finite and too large: refused wherever they come in, or borne without harm.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <offnominal/monitor.hpp>

#include "core/diagnosis/state_bits.hpp"
#include "core/print_status.hpp"
#include "core/watched_arm.hpp"

namespace offnominal::test {
namespace {

template <typename Scalar>
class MonitorOverflow : public testing::Test {
 protected:
  using Watch = typename WatchedArm<Scalar>::Watch;
  using Sample = JointSample<kArmJoints, Scalar>;

  // An arm whose file has no limits.
  void SetUp() override {
    auto config = arm_config<Scalar>();
    for (Joint<Scalar>& joint : config.chain.joints) {
      joint.max_velocity = joint.max_torque = std::numeric_limits<Scalar>::max();
    }
    ASSERT_EQ(Watch::create(config, monitor), Status::kOk);
  }
  static Sample huge(Scalar torque) {
    Sample sample = WatchedArm<Scalar>().sample();
    sample.tau[0] = torque;
    return sample;
  }
  // Healthy ticks from here on are taken, every one.
  void expect_usable(double torque) {
    WatchedArm<Scalar> arm;
    for (int i = 0; i < 20; ++i) {
      ASSERT_EQ(monitor.step(arm.move(0.001, 0.0), state, output), Status::kOk)
          << torque << " N m before, tick " << i;
    }
  }

  Watch monitor;
  typename Watch::State state;
  typename Watch::Output output;
};
using BothScalars = testing::Types<float, double>;
TYPED_TEST_SUITE(MonitorOverflow, BothScalars);

// GIVEN any finite torque WHEN a run starts with it THEN it is refused, and nothing has changed, or
// every healthy tick after it is taken.
TYPED_TEST(MonitorOverflow, ARunThatStartsCanGoOn) {
  const int most = std::numeric_limits<TypeParam>::max_exponent - 1;
  bool refused = false;
  for (int exponent = 0; exponent <= most; ++exponent) {
    this->state = {};
    const Bits before = bits_of(this->state);
    const auto torque = std::ldexp(TypeParam(1), exponent);
    const Status status = this->monitor.reset(TestFixture::huge(torque), this->state);
    if (status == Status::kOk) {
      this->expect_usable(static_cast<double>(torque));
    } else {
      refused = true;
      EXPECT_EQ(bits_of(this->state), before) << exponent;
    }
  }
  EXPECT_TRUE(refused);
}

TYPED_TEST(MonitorOverflow, ARunThatGoesOnAfterAGapCanGoOn) {
  const int most = std::numeric_limits<TypeParam>::max_exponent - 1;
  bool refused = false;
  for (int exponent = 0; exponent <= most; ++exponent) {
    ASSERT_EQ(this->monitor.reset(WatchedArm<TypeParam>().sample(), this->state), Status::kOk);
    this->expect_usable(0);
    const Bits before = bits_of(this->state);
    const auto torque = std::ldexp(TypeParam(1), exponent);
    const Status status = this->monitor.resume(TestFixture::huge(torque), 3, this->state);
    if (status != Status::kOk) {
      refused = true;
      EXPECT_EQ(bits_of(this->state), before) << exponent;
    }
    this->expect_usable(static_cast<double>(torque));
  }
  EXPECT_TRUE(refused);
}

}  // namespace
}  // namespace offnominal::test
