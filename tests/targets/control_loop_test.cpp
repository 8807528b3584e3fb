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
  const sim::JointState elsewhere{Eigen::Vector2d(0.5, 0.0), Eigen::Vector2d::Zero()};
  loop.plant = sim::PlantNode(paper_arm({}, elsewhere), two_drives(), {});
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

// GIVEN a loop that is to arm by itself WHEN that is refused for good, and the arm comes to lie
// right in one of the last ticks, THEN it is not armed any more.
TEST(ControlLoop, NothingArmsOnceARefusalHasEndedIt) {
  LoopOnBus loop;
  loop.reference_at = [&](double time_s) {
    Reference<2, float> reference = ArmOnBus::paper_reference(time_s);
    if (loop.panel.refusal.load() == Fault::kNone) reference.q[0] += 1;
    return reference;
  };
  const realtime::LoopReport report = loop.run({.arm_when_passive = true});
  EXPECT_EQ(report.refusal, Fault::kReferenceFarFromArm);
  EXPECT_EQ(loop.data->state, ControllerState::kPassive);
  EXPECT_FALSE(loop.plant.started());
}

// GIVEN the end is asked for WHEN the wish to arm comes before, with it or after it, or every joint
// is heard in one of the last ticks, THEN no drive is told to give torque.
TEST(ControlLoop, NothingArmsOnceItsEndIsAskedFor) {
  for (const int asked_to_arm : {50, 51, 52, 54}) {
    LoopOnBus loop;
    loop.timer.before_tick = [&](int tick) {
      if (tick == asked_to_arm) loop.panel.arm.store(true);
      if (tick == 50) loop.panel.end.store(true);
    };
    const realtime::LoopReport report = loop.run({});
    EXPECT_EQ(report.state, ControllerState::kPassive) << asked_to_arm;
    EXPECT_EQ(loop.data->state, ControllerState::kPassive) << asked_to_arm;
    EXPECT_FALSE(loop.plant.started()) << asked_to_arm;
  }
  for (const int end : {1, 2, 3, 4}) {
    LoopOnBus loop;
    loop.timer.before_tick = [&](int tick) {
      if (tick == end) loop.panel.end.store(true);
    };
    static_cast<void>(loop.run({.arm_when_passive = true}));
    EXPECT_NE(loop.data->state, ControllerState::kArmed) << end;
    EXPECT_FALSE(loop.plant.started()) << end;
  }
}

// GIVEN a fault with drives that damp WHEN the program ends THEN they are told "off" all the same,
// and nobody clears the fault any more.
TEST(ControlLoop, LeavesTheDrivesOffWhateverTheSafeMode) {
  auto config = ArmOnBus::config(false);
  config.safe_mode = hal::DriveMode::kDamping;
  LoopOnBus loop(config);
  hal::DriveMode before = hal::DriveMode::kOff;
  loop.timer.before_tick = [&](int tick) {
    if (tick > 100 && tick < 111) loop.timer.late_ticks = 1;
    if (tick == 150) before = loop.plant.drives().mode(0);
    if (tick == 150) loop.panel.end.store(true);
    if (tick == 151) loop.panel.clear.store(true);
  };
  const realtime::LoopReport report = loop.run({.arm_when_passive = true});
  EXPECT_EQ(report.fault, Fault::kOverrun);
  EXPECT_EQ(before, hal::DriveMode::kDamping);
  EXPECT_EQ(loop.data->state, ControllerState::kFault);
  EXPECT_EQ(loop.plant.drives().mode(0), hal::DriveMode::kOff);
  EXPECT_EQ(loop.plant.drives().mode(1), hal::DriveMode::kOff);
}

// GIVEN a fault in one of the last ticks WHEN its safe mode is to damp THEN it is "off" as well.
TEST(ControlLoop, LeavesTheDrivesOffAfterAFaultInItsLastTicks) {
  auto config = ArmOnBus::config(false);
  config.safe_mode = hal::DriveMode::kDamping;
  LoopOnBus loop(config);
  loop.timer.before_tick = [&](int tick) {
    if (tick == 100) loop.panel.end.store(true);
    loop.timer.plant_runs = tick < 102;
  };
  static_cast<void>(loop.run({.arm_when_passive = true}));
  EXPECT_EQ(loop.data->fault, Fault::kEncoderSilent);
  EXPECT_EQ(loop.data->commands[0].mode, hal::DriveMode::kOff);
}

// GIVEN a loop that is to arm once by itself WHEN there is a fault before, and somebody clears it,
// THEN it stays passive until it is asked to arm.
TEST(ControlLoop, AFaultEndsTheWishToArmByItself) {
  LoopOnBus loop;
  std::vector<ControllerState> states;
  loop.timer.before_tick = [&](int tick) {
    if (tick == 2) {
      hal::Record record{};
      using hal::MessageKind;
      static_cast<void>(
          encode(hal::EmergencyStop{7, 0}, 0, data_id_of(MessageKind::kEmergencyStop, 7), record));
      loop.send(frame_of(MessageKind::kEmergencyStop, 7, record));
    }
    if (tick % 50 == 0) states.push_back(loop.panel.state.load());
    if (tick == 50) loop.panel.clear.store(true);
    if (tick == 100) loop.panel.arm.store(true);
    if (tick == 150) loop.panel.end.store(true);
  };
  const realtime::LoopReport report = loop.run({.arm_when_passive = true});
  using S = ControllerState;
  EXPECT_EQ(report.fault, Fault::kEmergencyStop);
  EXPECT_EQ(states, (std::vector{S::kFault, S::kPassive, S::kArmed}));
}

TEST(ControlLoop, AFaultIsClearedAndArmedAgainOnlyWhenAskedTo) {
  LoopOnBus loop;
  std::vector<ControllerState> states;
  loop.timer.before_tick = [&](int tick) {
    loop.timer.plant_runs = tick < 100 || tick > 200;
    if (tick % 100 == 0) states.push_back(loop.panel.state.load());
    // Somebody brings it back: it has fallen.
    if (tick == 250) loop.plant = sim::PlantNode(paper_arm(), two_drives(), {});
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
