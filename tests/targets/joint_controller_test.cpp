#include <gtest/gtest.h>

#include <array>
#include <random>

#include "arm_on_bus.hpp"
#include "support/repetitions.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

using controller::Fault;
using hal::ControllerState;
using hal::DriveMode;

DriveMode commanded(const ArmOnBus& arm) { return arm.data->commands[0].mode; }

TEST(JointController, BecomesPassiveWhenEveryJointIsHeardAndCommandsNoTorque) {
  ArmOnBus arm;
  EXPECT_EQ(arm.arm(), Fault::kNotPassive) << "armed without a single frame";
  arm.tick();
  EXPECT_EQ(arm.data->state, ControllerState::kInit);
  for (int i = 0; i < 5; ++i) arm.tick();
  EXPECT_EQ(arm.data->state, ControllerState::kPassive);
  arm.run(0.5);
  EXPECT_EQ(commanded(arm), DriveMode::kOff);
  EXPECT_FALSE(arm.plant().started());
}

TEST(JointController, CommandsTorqueOnceArmed) {
  ArmOnBus arm;
  ASSERT_TRUE(arm.start());
  arm.run(0.1);
  EXPECT_EQ(arm.data->state, ControllerState::kArmed);
  EXPECT_EQ(commanded(arm), DriveMode::kTorque);
  EXPECT_TRUE(arm.plant().started());
  EXPECT_NE(arm.plant().applied_nm()[0], 0.0);
  EXPECT_EQ(arm.arm(), Fault::kNotPassive) << "armed twice";
}

// GIVEN an armed controller WHEN the encoder frames stop THEN it is in its safe state within three
// ticks, stays there when they come back, and torque takes two explicit steps.
TEST(JointController, IsSafeWithinThreeTicksOfSilence) {
  auto config = ArmOnBus::config(false);
  config.arming.speed.fill(20);  // it will be falling
  ArmOnBus arm({}, config, {});
  ASSERT_TRUE(arm.start());
  arm.run(0.1);
  arm.plant_runs = false;
  int ticks = 0;
  while (arm.data->state == ControllerState::kArmed && ticks < 10) {
    arm.tick();
    ++ticks;
  }
  EXPECT_LE(ticks, 3);
  EXPECT_EQ(arm.data->fault, Fault::kEncoderSilent);
  EXPECT_EQ(commanded(arm), DriveMode::kOff);
  arm.plant_runs = true;
  arm.run(0.5);
  EXPECT_EQ(arm.data->state, ControllerState::kFault) << "latched";
  EXPECT_EQ(arm.arm(), Fault::kNotPassive);
  ASSERT_TRUE(arm.clear_fault());
  EXPECT_EQ(arm.arm(), Fault::kNotPassive) << "armed before it has looked again";
  arm.tick();
  EXPECT_EQ(arm.data->state, ControllerState::kPassive);
  EXPECT_EQ(arm.arm(), Fault::kReferenceFarFromArm) << "it has fallen meanwhile";
  arm.reference_at = [&](double) {
    return Reference<2, float>{arm.data->sample.q, arm.data->sample.dq, {}};
  };
  EXPECT_EQ(arm.arm(), Fault::kNone);
}

TEST(JointController, CannotBeRearmedWithoutFreshFrames) {
  ArmOnBus arm;
  ASSERT_TRUE(arm.start());
  arm.run(0.1);
  arm.plant_runs = false;
  arm.run(0.1);
  ASSERT_TRUE(arm.clear_fault());
  arm.run(0.1);
  EXPECT_EQ(arm.data->state, ControllerState::kInit);
  EXPECT_EQ(arm.arm(), Fault::kNotPassive);
}

TEST(JointController, HoldsItsTorqueOverASingleLostTick) {
  ArmOnBus arm;
  ASSERT_TRUE(arm.start());
  arm.run(0.1);
  arm.plant_runs = false;
  arm.tick();
  EXPECT_EQ(arm.data->state, ControllerState::kArmed);
  EXPECT_EQ(arm.data->missed_samples, 1U);
  EXPECT_EQ(commanded(arm), DriveMode::kTorque);
  arm.plant_runs = true;
  arm.run(0.1);
  EXPECT_EQ(arm.data->state, ControllerState::kArmed);
  EXPECT_FALSE(arm.data->output.detector.latched);
}

TEST(JointController, StopsWhenSomebodyAsksForIt) {
  ArmOnBus arm;
  ASSERT_TRUE(arm.start());
  arm.run(0.1);
  hal::Record record{};
  ASSERT_EQ(
      encode(hal::EmergencyStop{7, 0}, 0, data_id_of(hal::MessageKind::kEmergencyStop, 7), record),
      hal::Status::kOk);
  ASSERT_EQ(
      arm.net.port(2).send(frame_of(hal::MessageKind::kEmergencyStop, 7, record), arm.now() + 1000),
      hal::Status::kOk);
  arm.tick();
  EXPECT_EQ(arm.data->state, ControllerState::kFault);
  EXPECT_EQ(arm.data->fault, Fault::kEmergencyStop);
  EXPECT_EQ(arm.plant().drives().mode(0), DriveMode::kOff);
}

TEST(JointController, IsSafeWhenTheBusIsLost) {
  ArmOnBus arm;
  ASSERT_TRUE(arm.start());
  arm.run(0.1);
  arm.net.set_mode(0, hal::BusMode::kOff);
  arm.tick();
  EXPECT_EQ(arm.data->fault, Fault::kBusLost);
}

// GIVEN a bus that carries nothing for a second WHEN it is free again THEN the drives see no torque
// of before: the controller is safe, and so are they.
TEST(JointController, NoOldTorqueComesOutOfABlockedBus) {
  ArmOnBus arm;
  ASSERT_TRUE(arm.start());
  arm.run(0.1);
  arm.net.set_blocked(true);
  arm.run(1.0);
  EXPECT_EQ(arm.data->state, ControllerState::kFault);
  EXPECT_EQ(arm.plant().drives().mode(0), DriveMode::kOff) << "the drives' own watch-dog";
  arm.net.set_blocked(false);
  std::array<hal::ReceivedFrame, 64> seen;
  const std::size_t count = arm.net.port(2).receive(seen);
  for (std::size_t i = 0; i < count; ++i) {
    hal::Address address;
    if (address_of(seen[i].frame, address) != hal::Status::kOk) continue;
    if (address.kind != hal::MessageKind::kTorqueCommand || seen[i].time_us < arm.now()) continue;
    hal::TorqueCommand command;
    std::uint8_t counter = 0;
    ASSERT_EQ(decode(record_in(seen[i].frame, 0), data_id_of(address.kind, address.first_node),
                     command, counter),
              hal::Status::kOk);
    EXPECT_NE(command.mode, DriveMode::kTorque);
  }
  arm.run(0.1);
  EXPECT_EQ(arm.plant().applied_nm()[0], 0.0);
}

TEST(JointController, CountsLateTicksAndStopsAtTooMany) {
  ArmOnBus arm;
  ASSERT_TRUE(arm.start());
  arm.run(0.1);
  const auto before = arm.data->run_ticks;
  arm.tick_controller(1);
  EXPECT_EQ(arm.data->run_ticks, before + 2) << "time goes on without the tick that was lost";
  arm.tick();
  EXPECT_EQ(arm.data->state, ControllerState::kArmed);
  for (int i = 0; i < 4; ++i) arm.tick_controller(1);
  EXPECT_EQ(arm.data->fault, Fault::kOverrun);
  EXPECT_EQ(arm.data->overruns, 5U);
}

// GIVEN ticks that come too late, and samples lost with them WHEN the arm is healthy THEN nothing
// is detected: time without samples is not taken for one tick.
TEST(JointController, LateTicksAreNoFaultOfTheArm) {
  ArmOnBus arm;
  ASSERT_TRUE(arm.start());
  for (int i = 0; i < 200; ++i) {
    arm.run(0.02);
    arm.tick_late(2);
    ASSERT_EQ(arm.data->state, ControllerState::kArmed) << i;
    ASSERT_FALSE(arm.data->output.detector.latched) << i;
  }
  EXPECT_EQ(arm.data->overruns, 200U);
  EXPECT_EQ(arm.data->monitor.tick, arm.data->run_ticks);
}

TEST(JointController, StopsAtADetectionWhereItShall) {
  auto config = ArmOnBus::config(false);
  config.at_detection = controller::AtDetection::kStop;
  ArmOnBus arm({.kind = sim::FaultKind::kNonlinear, .time_s = 1.0}, config, {});
  ASSERT_TRUE(arm.start());
  arm.run(3.0);
  EXPECT_EQ(arm.data->fault, Fault::kDetected);
}

// GIVEN drives that send positions alone WHEN the observer's error is in the bound THEN the arm
// follows its motion, nothing healthy is called a fault, and a fault is still found.
TEST(JointController, ObservesVelocitiesThatNobodySends) {
  auto config = ArmOnBus::config(false);
  const float most_acceleration = 20.0F;  // it starts at rest, and has to catch up
  config.monitor.bound.velocity_error = velocity_error_bound(
      config.velocity_observer, most_acceleration, 0.5F * hal::kPositionPerCount);
  ArmOnBus arm({.kind = sim::FaultKind::kNonlinear, .time_s = 4.0}, config,
               {.sends_velocity = false}, {Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()});
  ASSERT_TRUE(arm.start());
  arm.run(4.0);
  EXPECT_EQ(arm.data->state, ControllerState::kArmed);
  EXPECT_FALSE(arm.data->output.detector.latched);
  EXPECT_LT((arm.data->sample.dq.cast<double>() - arm.plant().state().dq).norm(), 0.1);
  arm.run(2.0);
  EXPECT_TRUE(arm.data->output.detector.latched);
}

TEST(JointController, ASampleOutOfRangeLeadsToTheSafeStateWithItsStatus) {
  auto config = ArmOnBus::config(false);
  for (auto& joint : config.monitor.chain.joints) joint.max_position = 0.01F;
  ArmOnBus arm({}, config, {});
  // The arm is on the move and has to be brought to a stop first.
  arm.reference_at = [](double) { return Reference<2, float>{}; };
  ASSERT_TRUE(arm.start());
  arm.run(2.0);
  EXPECT_EQ(arm.data->state, ControllerState::kFault);
  EXPECT_EQ(arm.data->fault, controller::fault_of(Status::kPositionOutOfRange));
  EXPECT_STREQ(name_of(arm.data->fault), "PositionOutOfRange");
}

TEST(JointController, RefusesAConfigurationThatCannotWork) {
  ArmOnBus::Controller controller;
  auto config = ArmOnBus::config(false);
  config.safe_mode = DriveMode::kTorque;
  EXPECT_EQ(ArmOnBus::Controller::create(config, controller), Status::kInvalidLimit);
  config = ArmOnBus::config(false);
  config.command_lifetime_us = 1001;
  EXPECT_EQ(ArmOnBus::Controller::create(config, controller), Status::kInvalidLimit);
  config = ArmOnBus::config(false);
  config.time_to_follow_us = -1;
  EXPECT_EQ(ArmOnBus::Controller::create(config, controller), Status::kInvalidLimit);
  config = ArmOnBus::config(false);
  config.gains.kp[0] = -1;
  EXPECT_EQ(ArmOnBus::Controller::create(config, controller), Status::kInvalidGain);
}

TEST(JointController, TimesFollowFromAnyPeriod) {
  for (const float period_s : {0.00025F, 0.001F, 0.0025F, 0.005F, 0.02F}) {
    auto monitor = ArmOnBus::config(false).monitor;
    monitor.estimator.period_s = period_s;
    const auto config = controller::controller_config(monitor, ArmOnBus::config(false).gains);
    EXPECT_EQ(validate(config), Status::kOk) << period_s << " s";
    EXPECT_NEAR(static_cast<double>(config.command_lifetime_us),
                0.9e6 * static_cast<double>(period_s), 1);
  }
  // The observer is judged at the period that it runs with, not at its own.
  auto config = ArmOnBus::config(false);
  config.velocity_observer.period_s = 1;
  EXPECT_EQ(validate(config), Status::kOk);
  config.velocity_observer.bandwidth_rad_s = 501;
  EXPECT_EQ(validate(config), Status::kInvalidFilterPole);
}

// Whatever comes in whatever order: torque is commanded in kArmed alone, kArmed is entered by arm()
// from kPassive alone, kFault is left by clear_fault() alone.
TEST(JointController, RandomEventsNeverBreakTheRulesOfItsStates) {
  std::mt19937_64 random = seeded_generator();
  std::uniform_int_distribution<int> event(0, 39);
  for (int trial = 0; trial < repetitions(100); ++trial) {
    ArmOnBus arm;
    for (int i = 0; i < 300; ++i) {
      const ControllerState before = arm.data->state;
      bool armed = false;
      bool cleared = false;
      switch (event(random)) {
        case 0:
          arm.plant_runs = !arm.plant_runs;
          break;
        case 1:
          arm.net.set_blocked(true);
          break;
        case 2:
          arm.net.set_blocked(false);
          break;
        case 3:
          cleared = arm.clear_fault();
          break;
        case 4:
        case 5:
          armed = arm.arm() == Fault::kNone;
          break;
        case 6:
          arm.stop(Fault::kEmergencyStop);
          break;
        case 7:
          arm.net.set_mode(0, hal::BusMode::kOff);
          break;
        case 8:
        case 9:
          arm.net.set_mode(0, hal::BusMode::kActive);
          break;
        default:
          arm.tick();
      }
      const ControllerState after = arm.data->state;
      if (commanded(arm) == DriveMode::kTorque && !armed) {
        const bool was_or_is =
            after == ControllerState::kArmed || before == ControllerState::kArmed;
        ASSERT_TRUE(was_or_is) << "trial " << trial;
      }
      ASSERT_TRUE(!armed || before == ControllerState::kPassive);
      if (after == ControllerState::kArmed && before != ControllerState::kArmed) {
        ASSERT_TRUE(armed);
      }
      if (before == ControllerState::kFault && after != ControllerState::kFault) {
        ASSERT_TRUE(cleared);
      }
      ASSERT_EQ(after == ControllerState::kFault, arm.data->fault != Fault::kNone);
    }
  }
}

}  // namespace
}  // namespace offnominal::test
