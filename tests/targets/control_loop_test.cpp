#include <gtest/gtest.h>

#include <vector>

#include "loop_on_bus.hpp"

namespace offnominal::test {
namespace {

using controller::Fault;
using hal::ControllerState;

TEST(ControlLoop, ArmsOnceEveryJointIsHeardAndEndsAfterItsTimeWithTheDrivesOff) {
  LoopOnBus loop;
  const realtime::LoopReport report = loop.run({.arm_when_passive = true, .duration_us = 500'000});
  EXPECT_EQ(report.state, ControllerState::kArmed);
  EXPECT_EQ(report.fault, Fault::kNone);
  EXPECT_EQ(report.overruns, 0U);
  EXPECT_NEAR(loop.plant.time_s(), 0.5, 0.01);
  EXPECT_EQ(loop.plant.drives().mode(0), hal::DriveMode::kOff);
  EXPECT_EQ(loop.data->state, ControllerState::kPassive);
}

TEST(ControlLoop, ArmsOnlyWhenAskedTo) {
  LoopOnBus loop;
  bool started_unasked = true;
  loop.timer.before_tick = [&](int tick) {
    if (tick == 300) {
      started_unasked = loop.plant.started();
      loop.panel.arm.store(true);
    }
    if (tick == 400) loop.panel.end.store(true);
  };
  const realtime::LoopReport report = loop.run({});
  EXPECT_FALSE(started_unasked);
  EXPECT_TRUE(loop.plant.started());
  EXPECT_EQ(report.state, ControllerState::kArmed);
}

// GIVEN an arm that lies elsewhere than its motion begins WHEN the loop is to arm it by itself THEN
// it says why not and ends, and does not wait for somebody to move the arm there.
TEST(ControlLoop, EndsWhereArmingIsRefused) {
  LoopOnBus loop;
  sim::JointState elsewhere;
  elsewhere.q = {0.5, 0.0};
  loop.plant = sim::PlantNode(sim::TwoLinkPlant({}, {}, sim::paper_uncertainty()), elsewhere, {});
  loop.timer.before_tick = [&](int tick) { loop.panel.end.store(tick == 500); };
  const realtime::LoopReport report = loop.run({.arm_when_passive = true});
  EXPECT_EQ(report.refusal, Fault::kReferenceFarFromArm);
  EXPECT_EQ(loop.panel.refusal.load(), Fault::kReferenceFarFromArm);
  EXPECT_EQ(report.fault, Fault::kNone);
  EXPECT_LT(report.ticks, 50U);
  EXPECT_FALSE(loop.plant.started());
}

TEST(ControlLoop, WhoAsksForArmingIsToldWhyNot) {
  LoopOnBus loop;
  loop.timer.before_tick = [&](int tick) {
    if (tick == 1) loop.panel.arm.store(true);
    if (tick == 100) loop.panel.end.store(true);
  };
  const realtime::LoopReport report = loop.run({});
  EXPECT_EQ(loop.panel.refusal.load(), Fault::kNotPassive) << "nothing had been heard yet";
  EXPECT_EQ(report.refusal, Fault::kNone) << "it goes on";
  EXPECT_GE(report.ticks, 100U);
}

// GIVEN an armed loop WHEN ticks begin periods too late THEN each is counted, none is made up for,
// and more in a row than are allowed lead to the safe state.
TEST(ControlLoop, CountsLateTicksAndBearsAFew) {
  LoopOnBus loop;
  loop.timer.before_tick = [&](int tick) {
    if (tick == 200 || tick == 300) loop.timer.late_ticks = 1;
  };
  const realtime::LoopReport report = loop.run({.arm_when_passive = true, .duration_us = 500'000});
  EXPECT_EQ(report.overruns, 2U);
  EXPECT_EQ(report.left_out, 2U);
  EXPECT_EQ(report.worst_late_us, 1000);
  EXPECT_EQ(report.fault, Fault::kNone);
  EXPECT_LT(report.ticks, 510U);
}

TEST(ControlLoop, ManyLateTicksInARowAreAFault) {
  LoopOnBus loop;
  loop.timer.before_tick = [&](int tick) { loop.timer.late_ticks = tick > 100 ? 1 : 0; };
  const realtime::LoopReport report =
      loop.run({.arm_when_passive = true, .duration_us = 500'000, .end_at_fault = true});
  EXPECT_EQ(report.fault, Fault::kOverrun);
  EXPECT_EQ(report.state, ControllerState::kFault);
  EXPECT_EQ(report.overruns, report.left_out);
  EXPECT_LT(report.ticks, 200U) << "it ends 0.1 s after the fault";
}

TEST(ControlLoop, AFaultIsClearedAndArmedAgainOnlyWhenAskedTo) {
  auto config = ArmOnBus::config(false);
  config.arming.speed.fill(20);  // the arm falls meanwhile, and is caught where it is
  LoopOnBus loop(config);
  loop.reference_at = [&](double) {
    return Reference<2, float>{loop.data->sample.q, loop.data->sample.dq, {}};
  };
  std::vector<ControllerState> states;
  loop.timer.before_tick = [&](int tick) {
    loop.timer.plant_runs = tick < 100 || tick > 200;
    if (tick % 100 == 0) states.push_back(loop.panel.state.load());
    if (tick == 300) loop.panel.clear.store(true);
    if (tick == 400) loop.panel.arm.store(true);
    if (tick == 500) loop.panel.end.store(true);
  };
  const realtime::LoopReport report = loop.run({.arm_when_passive = true});
  using S = ControllerState;
  EXPECT_EQ(states, (std::vector{S::kArmed, S::kFault, S::kFault, S::kPassive, S::kArmed}));
  EXPECT_EQ(report.fault, Fault::kEncoderSilent) << "the first stays in the report";
  EXPECT_EQ(report.state, ControllerState::kArmed);
}

}  // namespace
}  // namespace offnominal::test
