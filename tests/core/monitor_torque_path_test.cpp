#include <gtest/gtest.h>

#include <cmath>
#include <offnominal/monitor.hpp>

#include "core/print_status.hpp"
#include "core/watched_arm.hpp"

// A monitored arm whose drives give another torque than they are told, through gears whose friction
// grows with what they transmit. The log's torque comes from the closed form.

namespace offnominal::test {
namespace {

using Watch = WatchedArm<double>::Watch;
using Sample = WatchedArm<double>::Sample;
constexpr double kFactor = 0.15;
constexpr double kSmoothing = 0.05;
const Eigen::Vector2d kError(0.25, -0.2);

MonitorConfig<kArmJoints, double> config_with_path() {
  auto config = arm_config<double>();
  for (const std::uint8_t joint : {std::uint8_t{0}, std::uint8_t{1}}) {
    EXPECT_TRUE(config.chain.effects.add(
        {EffectKind::kLoadDependentFriction, joint, {kFactor, kSmoothing}}));
    EXPECT_TRUE(config.chain.effects.add({EffectKind::kTorqueScale, joint, {kError[joint]}}));
  }
  return config;
}

// The same sample as the log of that arm has it.
Sample told(Sample sample) {
  for (Eigen::Index i = 0; i < 2; ++i) {
    const double friction =
        kFactor * std::fabs(sample.tau[i]) * std::tanh(sample.dq[i] / kSmoothing);
    sample.tau[i] = (1 + kError[i]) * (sample.tau[i] + friction);
  }
  return sample;
}

struct Watched {
  Watch monitor;
  Watch::State state;
  Watch::Output output;
};

Watched start(const MonitorConfig<kArmJoints, double>& config, const Sample& first) {
  Watched watched;
  EXPECT_EQ(Watch::create(config, watched.monitor), Status::kOk);
  EXPECT_EQ(watched.monitor.reset(first, watched.state), Status::kOk);
  return watched;
}

TEST(MonitorTorquePath, GivenAModelThatKnowsThePathThenAHealthyArmIsHealthy) {
  WatchedArm<double> arm;
  auto knowing = start(config_with_path(), told(arm.sample()));
  auto ignorant = start(arm_config<double>(), told(arm.sample()));
  double largest = 0;
  for (int tick = 0; tick < 4000; ++tick) {
    const Sample sample = told(arm.move(0.001, 0.0));
    ASSERT_EQ(knowing.monitor.step(sample, knowing.state, knowing.output), Status::kOk);
    ASSERT_EQ(ignorant.monitor.step(sample, ignorant.state, ignorant.output), Status::kOk);
    largest = std::max(largest, knowing.output.error_norm);
  }
  EXPECT_LT(largest, 1e-5);
  EXPECT_FALSE(knowing.output.detector.latched);
  EXPECT_TRUE(ignorant.output.detector.latched);
}

// What is added to the command takes the learnt fault away, behind the drive and the gear.
TEST(MonitorTorquePath, GivenAFaultThenTheCompensationIsWhatTheDriveHasToBeTold) {
  WatchedArm<double> arm;
  auto watched = start(config_with_path(), told(arm.sample()));
  int compared = 0;
  for (int tick = 0; tick < 6000; ++tick) {
    const Sample sample = told(arm.move(0.001, 3.0));
    ASSERT_EQ(watched.monitor.step(sample, watched.state, watched.output), Status::kOk);
    const auto& output = watched.output;
    ForwardDynamics<2, double> before;
    ForwardDynamics<2, double> after;
    const auto& model = watched.monitor.model();
    const Eigen::Vector2d tau_r = sample.tau + output.compensation.torque;
    ASSERT_EQ((forward_dynamics<2, double>(model, sample.q, sample.dq, sample.tau, 0, before)),
              Status::kOk);
    ASSERT_EQ((forward_dynamics<2, double>(model, sample.q, sample.dq, tau_r, 0, after)),
              Status::kOk);
    const bool same_side = before.told_per_load == after.told_per_load;
    if (!same_side || output.compensation.saturated || output.psi_hat.norm() < 0.1) continue;
    ++compared;
    const Eigen::Vector2d expected = before.ddq - output.psi_hat;
    ASSERT_LE((after.ddq - expected).norm(), 1e-9 * (1 + expected.norm()));
  }
  EXPECT_TRUE(watched.output.detector.latched);
  EXPECT_GT(compared, 2000);
}

// A held torque jumps at the sample, and so does the load behind the path: a monitor that knows the
// path and is told the told torque goes on as one of the bare arm that is told the load.
TEST(MonitorTorquePath, GivenAHeldTorqueThatJumpsThenTheLoadsJumpIsTaken) {
  auto with_path = config_with_path();
  auto bare = arm_config<double>();
  for (auto* config : {&with_path, &bare}) {
    config->torque_signal = TorqueSignal::kHeld;
    config->bound.offset = 1e6;  // nothing is learnt: the network's inputs differ
  }
  Sample load;
  load.q << 0.3, -0.4;
  load.dq << 2, -2;  // the smoothed sign is 1 to the last digit
  load.tau << 20, -8;
  auto knowing = start(with_path, told(load));
  auto plain = start(bare, load);
  for (int tick = 0; tick < 200; ++tick) {
    const double jump = tick % 3 == 0 ? 30 : -25;
    load.tau << jump, 0.5 * jump;
    load.q += 0.001 * load.dq;
    ASSERT_EQ(knowing.monitor.step(told(load), knowing.state, knowing.output), Status::kOk);
    ASSERT_EQ(plain.monitor.step(load, plain.state, plain.output), Status::kOk);
    ASSERT_LE((knowing.output.error - plain.output.error).norm(), 1e-11) << tick;
    ASSERT_GT(plain.output.error_norm, 1e-4);
  }
  EXPECT_FALSE(plain.output.detector.latched);
}

}  // namespace
}  // namespace offnominal::test
