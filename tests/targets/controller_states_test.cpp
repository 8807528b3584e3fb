// The ways from state to state, and what goes out on the bus in each.
#include <gtest/gtest.h>

#include <offnominal/controller/feedback_check.hpp>
#include <offnominal/controller/sample_taker.hpp>
#include <offnominal/controller/takeover.hpp>

#include "scripted_joints.hpp"

namespace offnominal::test {
namespace {

using controller::Fault;
using hal::ControllerState;
using hal::DriveMode;
using hal::SourceState;
using Config = ScriptedJoints::Controller::Config;

TEST(ControllerStates, AreLeftForPassiveWhenAllIsHeardAndNotBefore) {
  for (std::size_t j = 0; j < ScriptedJoints::kJoints; ++j) {
    for (const bool of_encoder : {true, false}) {
      ScriptedJoints arm;
      arm.be_heard();
      hal::JointFeedback& silent = arm.drives.joints[j];
      (of_encoder ? silent.encoder : silent.drive) = SourceState::kNeverSeen;
      arm.run(5);
      EXPECT_EQ(arm.state(), ControllerState::kInit);
      EXPECT_EQ(arm.fault(), Fault::kNone);
      silent.encoder = silent.drive = SourceState::kValid;
      arm.tick();
      EXPECT_EQ(arm.state(), ControllerState::kPassive);
    }
  }
}

TEST(ControllerStates, TorqueIsCommandedInArmedAlone) {
  ScriptedJoints arm;
  arm.tick();
  EXPECT_TRUE(arm.all_commanded(DriveMode::kOff));
  arm.become_passive();
  arm.run(3);
  EXPECT_TRUE(arm.all_commanded(DriveMode::kOff));
  ASSERT_TRUE(arm.arm());
  EXPECT_EQ(arm.state(), ControllerState::kArmed);
  arm.tick();
  EXPECT_TRUE(arm.all_commanded(DriveMode::kTorque));
  ASSERT_TRUE(arm.disarm());
  EXPECT_EQ(arm.state(), ControllerState::kPassive);
  arm.tick();
  EXPECT_TRUE(arm.all_commanded(DriveMode::kOff));
}

// Each of the three steps is refused, and changes nothing, wherever it has no place.
TEST(ControllerStates, StepsOutOfPlaceChangeNothing) {
  ScriptedJoints arm;
  const auto refuses = [&arm](bool arms, bool disarms, bool clears) {
    const ControllerState before = arm.state();
    const Fault fault = arm.fault();
    EXPECT_FALSE(!arms && arm.arm());
    EXPECT_FALSE(!disarms && arm.disarm());
    EXPECT_FALSE(!clears && arm.clear_fault());
    EXPECT_EQ(arm.state(), before);
    EXPECT_EQ(arm.fault(), fault);
  };
  refuses(false, false, false);
  arm.become_passive();
  refuses(true, false, false);
  ASSERT_TRUE(arm.arm());
  refuses(false, true, false);
  arm.stop(Fault::kBusLost);
  refuses(false, false, true);
  ASSERT_TRUE(arm.clear_fault());
  EXPECT_EQ(arm.state(), ControllerState::kInit);
  EXPECT_EQ(arm.fault(), Fault::kNone);
  refuses(false, false, false);
}

TEST(ControllerStates, EveryRunBeginsAtTimeZeroWithAMonitorOfItsOwn) {
  ScriptedJoints arm;
  ASSERT_TRUE(arm.start());
  arm.run(50);
  EXPECT_GE(arm.data->run_ticks, 50U);
  EXPECT_EQ(arm.data->monitor.tick, arm.data->run_ticks);
  ASSERT_TRUE(arm.disarm());
  EXPECT_FALSE(arm.data->monitor.initialised);
  arm.run(20);
  ASSERT_TRUE(arm.arm());
  EXPECT_EQ(arm.data->run_ticks, 0U);
  EXPECT_EQ(arm.data->waiting_ticks, 0U);
  EXPECT_FALSE(arm.data->drives_follow);
  EXPECT_FALSE(arm.data->monitor.initialised);
  std::vector<double> asked;
  arm.reference_at = [&asked](double time_s) {
    asked.push_back(time_s);
    return Reference<2, double>{};
  };
  arm.run(10);
  ASSERT_FALSE(asked.empty());
  EXPECT_EQ(asked.front(), 0.0);
  EXPECT_EQ(arm.data->monitor.tick, arm.data->run_ticks);
}

// GIVEN frames that wait on the bus WHEN the controller becomes safe, by itself or because somebody
// stops it, THEN they are dropped once, and all that is sent from then on is the safe mode.
TEST(ControllerStates, NothingOlderThanAFaultGoesOut) {
  for (const DriveMode safe : {DriveMode::kOff, DriveMode::kDamping}) {
    for (const bool by_itself : {true, false}) {
      Config config = ScriptedJoints::default_config();
      config.safe_mode = safe;
      ScriptedJoints arm(config);
      ASSERT_TRUE(arm.start());
      ASSERT_EQ(arm.bus.drops, 0);
      if (by_itself) {
        arm.drives.stop = true;
      } else {
        arm.stop(Fault::kEmergencyStop);
        EXPECT_EQ(arm.state(), ControllerState::kFault);
        EXPECT_TRUE(arm.bus.sent.empty());
      }
      arm.tick();
      EXPECT_EQ(arm.state(), ControllerState::kFault);
      EXPECT_EQ(arm.fault(), Fault::kEmergencyStop);
      EXPECT_EQ(arm.bus.drops, 1);
      EXPECT_EQ(arm.bus.sent.size(), ScriptedJoints::kJoints);
      for (int i = 0; i < 5; ++i) {
        EXPECT_TRUE(arm.all_commanded(safe));
        for (const hal::TorqueCommand& command : arm.drives.commands) {
          EXPECT_EQ(command.torque, 0.0F);
        }
        arm.tick();
      }
      EXPECT_EQ(arm.bus.drops, 1);
    }
  }
}

// Nobody looks after drives that were let go: they are told "off" in every state, until arm().
TEST(ControllerStates, DrivesThatAreLetGoAreOff) {
  Config config = ScriptedJoints::default_config();
  config.safe_mode = DriveMode::kDamping;
  ScriptedJoints arm(config);
  const auto let_go = [&arm] {
    arm.controller.let_go(*arm.data);
    for (const auto& command : arm.data->commands) {
      EXPECT_EQ(command.mode, DriveMode::kOff) << "from now on";
    }
    arm.tick();
    EXPECT_TRUE(arm.all_commanded(DriveMode::kOff));
  };
  ASSERT_TRUE(arm.start());
  let_go();
  EXPECT_EQ(arm.state(), ControllerState::kPassive);
  EXPECT_FALSE(arm.data->monitor.initialised);
  arm.drives.stop = true;
  arm.tick();
  ASSERT_EQ(arm.state(), ControllerState::kFault);
  EXPECT_TRUE(arm.all_commanded(DriveMode::kOff)) << "not damping";
  for (const auto& command : arm.data->commands) EXPECT_EQ(command.torque, 0.0F);
  ASSERT_TRUE(arm.clear_fault());
  ASSERT_TRUE(arm.start());
  arm.drives.stop = true;
  arm.tick();
  EXPECT_TRUE(arm.all_commanded(DriveMode::kDamping)) << "a new run is looked after";
  let_go();
  EXPECT_EQ(arm.state(), ControllerState::kFault);
  EXPECT_EQ(arm.fault(), Fault::kEmergencyStop);
}

TEST(ControllerStates, TheTimeOfARunEndsWithIt) {
  for (const bool disarmed : {true, false}) {
    ScriptedJoints arm;
    ASSERT_TRUE(arm.start());
    arm.run(20);
    const std::uint64_t ticks = arm.data->run_ticks;
    EXPECT_GT(ticks, 15U);
    if (disarmed) {
      ASSERT_TRUE(arm.disarm());
    } else {
      arm.stop(Fault::kOverrun);
    }
    arm.run(20);
    EXPECT_EQ(arm.data->run_ticks, ticks) << (disarmed ? "disarmed" : "a fault");
  }
}

// Nothing of a fault's safe mode is left once it is cleared: brakes and drives are off again.
TEST(ControllerStates, TheSafeModeEndsWithItsFault) {
  Config config = ScriptedJoints::default_config();
  config.safe_mode = DriveMode::kDamping;
  ScriptedJoints arm(config);
  ASSERT_TRUE(arm.start());
  arm.stop(Fault::kOverrun);
  arm.run(3);
  EXPECT_TRUE(arm.all_commanded(DriveMode::kDamping));
  ASSERT_TRUE(arm.clear_fault());
  arm.tick();
  EXPECT_TRUE(arm.all_commanded(DriveMode::kOff));
}

TEST(ControllerStates, ADisarmedControllerHasNoCommandLeft) {
  ScriptedJoints arm;
  ASSERT_TRUE(arm.start());
  ASSERT_TRUE(arm.disarm());
  for (const auto& command : arm.data->commands) EXPECT_EQ(command.mode, DriveMode::kOff);
  EXPECT_FALSE(arm.data->monitor.initialised);
}

TEST(ControllerStates, TheFirstFaultIsTheOneThatIsKept) {
  ScriptedJoints arm;
  ASSERT_TRUE(arm.start());
  arm.drives.joints[0].encoder = SourceState::kStale;
  arm.tick();
  ASSERT_EQ(arm.fault(), Fault::kEncoderSilent);
  arm.drives.stop = true;
  arm.bus.mode = hal::BusMode::kOff;
  arm.run(5);
  arm.stop(Fault::kOverrun);
  EXPECT_EQ(arm.fault(), Fault::kEncoderSilent);
  EXPECT_EQ(arm.bus.drops, 1);
}

// Whoever clears the fault has seen who asked for the stop: the same stop is no second one.
TEST(ControllerStates, AClearedStopIsForgotten) {
  ScriptedJoints arm;
  ASSERT_TRUE(arm.start());
  arm.drives.stop = true;
  arm.tick();
  ASSERT_EQ(arm.fault(), Fault::kEmergencyStop);
  ASSERT_TRUE(arm.clear_fault());
  EXPECT_FALSE(arm.drives.stop);
  arm.tick();
  EXPECT_EQ(arm.state(), ControllerState::kPassive);
}

TEST(ControllerStates, LateTicksOfBeforeAreForgottenWithTheFault) {
  ScriptedJoints arm;
  ASSERT_TRUE(arm.start());
  for (int i = 0; i < 5; ++i) arm.tick(1);
  ASSERT_EQ(arm.fault(), Fault::kOverrun);
  ASSERT_TRUE(arm.clear_fault());
  EXPECT_EQ(arm.data->late_in_a_row, 0);
  arm.tick(1);
  EXPECT_EQ(arm.state(), ControllerState::kPassive);
}

TEST(ControllerStates, TheHeartbeatTellsStateFaultAndTicks) {
  ScriptedJoints arm;
  arm.tick();
  EXPECT_EQ(arm.drives.heartbeat.state, ControllerState::kInit);
  EXPECT_EQ(arm.drives.heartbeat.fault, 0);
  EXPECT_EQ(arm.drives.heartbeat.ticks, 1U);
  ASSERT_TRUE(arm.start());
  EXPECT_EQ(arm.drives.heartbeat.state, ControllerState::kArmed);
  EXPECT_EQ(arm.drives.heartbeat.ticks, 5U);
  arm.drives.stop = true;
  arm.tick(3);
  EXPECT_EQ(arm.drives.heartbeat.state, ControllerState::kFault);
  EXPECT_EQ(arm.drives.heartbeat.fault, static_cast<std::uint8_t>(Fault::kEmergencyStop));
  EXPECT_EQ(arm.drives.heartbeat.ticks, 6U);
}

TEST(ControllerStates, EveryFrameOfATickHasItsDeadline) {
  Config config = ScriptedJoints::default_config();
  config.command_lifetime_us = 700;
  ScriptedJoints arm(config);
  arm.bus.time_us = 5000;
  arm.tick();
  ASSERT_EQ(arm.bus.sent.size(), ScriptedJoints::kJoints);
  for (std::size_t j = 0; j < ScriptedJoints::kJoints; ++j) {
    EXPECT_EQ(arm.bus.sent[j].frame.id, 0x100 + j);
    EXPECT_EQ(arm.bus.sent[j].deadline_us, 6700);
  }
  EXPECT_EQ(arm.data->unsent_frames, 0U);
  arm.bus.sending = hal::Status::kQueueFull;
  arm.run(3);
  EXPECT_EQ(arm.data->unsent_frames, 3U * ScriptedJoints::kJoints);
}

TEST(ControllerStates, AConfigurationIsTakenWholeOrNotAtAll) {
  Config config = ScriptedJoints::default_config();
  config.late_ticks_allowed = 7;
  ScriptedJoints::Controller controller;
  ASSERT_EQ(ScriptedJoints::Controller::create(config, controller), Status::kOk);
  EXPECT_EQ(controller.config().late_ticks_allowed, 7);
  EXPECT_EQ(controller.monitor().config().estimator.hidden_units, 4);
  config.late_ticks_allowed = 9;
  config.monitor.estimator.period_s = 0;
  EXPECT_NE(ScriptedJoints::Controller::create(config, controller), Status::kOk);
  config = ScriptedJoints::default_config();
  config.late_ticks_allowed = 9;
  config.monitor.chain.joints[0].mass_kg = -1;
  EXPECT_EQ(ScriptedJoints::Controller::create(config, controller), Status::kInvalidMass);
  EXPECT_EQ(controller.config().late_ticks_allowed, 7);
}

TEST(ControllerStates, ItsDataBeginAtNothing) {
  const ScriptedJoints::Controller::Data data;
  EXPECT_EQ(data.state, ControllerState::kInit);
  EXPECT_EQ(data.fault, Fault::kNone);
  EXPECT_EQ(data.ticks + data.waiting_ticks + data.run_ticks + data.unseen_ticks, 0U);
  EXPECT_EQ(data.overruns + data.missed_samples + data.refused_frames + data.unsent_frames, 0U);
  EXPECT_EQ(data.late_in_a_row, 0);
  EXPECT_EQ(data.late_ticks, 0U);
  EXPECT_EQ(data.held_since, 0U);
  EXPECT_EQ(data.implausible_in_a_row, 0);
  EXPECT_FALSE(data.fresh);
  EXPECT_FALSE(data.holds);
  EXPECT_FALSE(data.drives_follow);
  EXPECT_FALSE(data.ends);
  for (const auto& turn : data.turns) {
    EXPECT_FALSE(turn.started);
    EXPECT_EQ(turn.tens, 0);
  }
}

}  // namespace
}  // namespace offnominal::test
