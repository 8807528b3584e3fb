#include "live/bus_samples.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "desk/sil/serial_robot.hpp"
#include "sil/both_ends.hpp"
#include "sil/sil.hpp"

namespace offnominal::desk::live {
namespace {

using sil::BothEnds;
using sil::Scenario;

Scenario scenario_of(const RobotDescription& robot) {
  Scenario scenario;
  scenario.plant = robot;
  return scenario;
}

struct Heard {
  std::vector<BusSample> samples;
  std::vector<JointSample<kRuntimeJoints, double>>
      controllers;  // what the controller had, tick by tick
  std::optional<hal::Heartbeat> heartbeat;
};

// What a listener makes of a run's frames, without those that `is_lost` names by their number.
template <typename IsLost>
Heard listen(const RobotDescription& robot, int ticks, const IsLost& is_lost) {
  Heard heard;
  BusSamples samples(robot);
  std::size_t number = 0;
  const Scenario scenario = scenario_of(robot);
  const auto wire = sil::make_in_process_wire();
  BothEnds ends(robot, scenario, *wire, [&](const hal::Frame& frame, hal::Microseconds time_us) {
    if (is_lost(number++)) return;
    if (const BusSample* sample = samples.take({frame, time_us})) heard.samples.push_back(*sample);
  });
  ends.start();
  for (int i = 0; i < ticks; ++i) {
    ends.tick();
    const ControllerView view = ends.controller().view();
    heard.controllers.push_back({view.seen.q, view.seen.dq, view.tau});
  }
  heard.heartbeat = samples.heartbeat();
  return heard;
}

class Listener : public testing::TestWithParam<const char*> {
 protected:
  static RobotDescription robot() {
    return std::string(GetParam()) == "odrives" ? test::odrive_robot(2, 1, "0.6")
                                                : test::by_joint_robot(3, 0.5);
  }
};

// Bit for bit what the controller had, and with it the torques of the same tick.
TEST_P(Listener, HasEverySampleAsTheControllerHadIt) {
  const Heard heard = listen(robot(), 500, [](std::size_t) { return false; });
  ASSERT_GT(heard.samples.size(), 450U);
  // The last sample waits for the reading behind it.
  std::size_t at = heard.controllers.size() - 1;
  for (std::size_t i = heard.samples.size(); i-- > heard.samples.size() - 400;) {
    --at;
    const JointSample<kRuntimeJoints, double>& sample = heard.samples[i].sample.joints;
    EXPECT_EQ(heard.samples[i].missing, 0U);
    ASSERT_TRUE(sample.q.isApprox(heard.controllers[at].q, 1e-6)) << i;
    ASSERT_TRUE(sample.tau.isApprox(heard.controllers[at].tau, 1e-6)) << i;
    ASSERT_EQ(heard.samples[i].sample.readings, sample.q);
  }
  EXPECT_TRUE(heard.samples.back().driven);
}

INSTANTIATE_TEST_SUITE_P(Drives, Listener, testing::Values("protected", "odrives"));

TEST(BusSamples, CountsTheTicksThatAreMissing) {
  const RobotDescription robot = test::by_joint_robot(2, 0.5);
  // Everything of some ticks in the middle.
  const Heard heard =
      listen(robot, 500, [](std::size_t number) { return number > 2000 && number < 2030; });
  std::uint32_t missing = 0;
  for (const BusSample& sample : heard.samples) missing += sample.missing;
  EXPECT_GT(missing, 1U);
  EXPECT_LT(missing, 12U);
  hal::Microseconds last_us = heard.samples.front().time_us;
  for (std::size_t i = 1; i < heard.samples.size(); ++i) {
    const BusSample& sample = heard.samples[i];
    EXPECT_EQ(sample.time_us - last_us, 1000 * (1 + hal::Microseconds{sample.missing}));
    last_us = sample.time_us;
  }
}

TEST(BusSamples, HearsTheControllersStateAndWhoSaysNothing) {
  const RobotDescription robot = test::by_joint_robot(2, 0.5);
  const Heard heard = listen(robot, 100, [](std::size_t) { return false; });
  ASSERT_TRUE(heard.heartbeat.has_value());
  EXPECT_EQ(heard.heartbeat->state, hal::ControllerState::kArmed);
  const BusSamples silent(robot);
  EXPECT_THAT(silent.silent_joints(1000), testing::ElementsAre(0U, 1U));
}

TEST(BusSamples, TakesNothingOfStrangersFrames) {
  BusSamples samples(test::by_joint_robot(2, 0.5));
  hal::Frame frame;
  frame.id = 0x555;
  frame.length = 8;
  for (int i = 0; i < 100; ++i) EXPECT_EQ(samples.take({frame, 1000 * i}), nullptr);
  EXPECT_EQ(samples.frames(), 100U);
  EXPECT_EQ(samples.understood(), 0U);
}

}  // namespace
}  // namespace offnominal::desk::live
