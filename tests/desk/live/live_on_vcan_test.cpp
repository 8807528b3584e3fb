// A live view of a bus of the kernel: it hears a run on it, and is itself never heard.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <memory>
#include <offnominal/hal/bus/can_listener.hpp>
#include <offnominal/hal/bus/socketcan.hpp>
#include <thread>
#include <utility>

#include "desk/sil/serial_robot.hpp"
#include "live/live.hpp"
#include "sil/both_ends.hpp"

namespace offnominal::desk::live {
namespace {

TEST(LiveOnVcan, HearsARunAndSendsNothing) {
  const RobotDescription robot = test::by_joint_robot(2, 0.5);
  hal::SocketCan bystander;  // sees every frame on the bus, whoever sends it
  ASSERT_EQ(bystander.open({.interface = "vcan0", .may_restart_interface = false}),
            hal::Status::kOk);
  LiveInput input;
  input.robot = robot;
  input.robot_file = "arm.toml";
  input.bus = "vcan0";
  Live live(std::move(input));
  std::array<hal::ReceivedFrame, 64> frames;
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_EQ(bystander.receive(frames), 0U);
  EXPECT_EQ(live.moment(0).frames, 0U);

  sil::Scenario scenario;
  scenario.plant = robot;
  const auto wire = sil::make_socketcan_wire("vcan0");
  std::uint64_t sent = 0;
  std::uint64_t seen = 0;
  sil::BothEnds ends(robot, scenario, *wire,
                     [&](const hal::Frame& /*frame*/, hal::Microseconds /*time_us*/) { ++sent; });
  const auto look = [&] {
    for (std::size_t count = bystander.receive(frames); count > 0;
         count = bystander.receive(frames)) {
      seen += count;
    }
  };
  ends.start();
  for (int i = 0; i < 1500; ++i) {
    ends.tick();
    look();
  }
  // A machine without acceleration is behind: what waits in the kernel is still to be read.
  Moment moment;
  for (int i = 0; i < 600 && moment.frames + moment.overflow < sent; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    moment = live.moment(0);
  }
  look();
  EXPECT_EQ(seen, sent);
  EXPECT_EQ(moment.frames, sent);
  EXPECT_EQ(moment.overflow, 0U);
  EXPECT_EQ(moment.rejected, 0U);
  ASSERT_TRUE(moment.controller.has_value());
  EXPECT_EQ(moment.controller->state, hal::ControllerState::kArmed);
  EXPECT_TRUE(moment.is_judging);
  EXPECT_GT(moment.t_s, 0.1);
}

}  // namespace
}  // namespace offnominal::desk::live
