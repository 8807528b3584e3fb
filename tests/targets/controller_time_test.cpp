// Runs that last for months, and stamps that are not of now.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <offnominal/hal/bus/in_process_bus.hpp>
#include <offnominal/hal/protocols/protected/protected_drives.hpp>
#include <vector>

#include "joint_on_desk.hpp"

namespace offnominal::test {
namespace {

using controller::Fault;
using hal::ControllerState;

constexpr std::uint64_t kYear = 365ULL * 24 * 3600 * 1000;  // ticks of 1 ms

// GIVEN a float controller that follows a sine WHEN a year has passed, or 32 bits of ticks have
// just run out, THEN it follows it as on the first day: every tick has a time of its own.
TEST(LongRun, FollowsItsReferenceAfterAYearAsOnTheFirstDay) {
  const std::uint64_t wrap = (1ULL << 32U) - 500;
  for (const std::uint64_t before : {std::uint64_t{0}, wrap, kYear}) {
    JointOnDesk joint;
    const double period_s = static_cast<double>(JointOnDesk::config().monitor.estimator.period_s);
    const double origin_s = static_cast<double>(before) * period_s;
    std::vector<double> times;
    joint.reference_at = [&](double time_s) {
      times.push_back(time_s);
      const double t = time_s < origin_s ? 0 : time_s - origin_s;
      Reference<1, float> reference;
      reference.q[0] = static_cast<float>(0.1 * (1 - std::cos(3 * t)));
      reference.dq[0] = static_cast<float>(0.3 * std::sin(3 * t));
      reference.ddq[0] = static_cast<float>(0.9 * std::cos(3 * t));
      return reference;
    };
    ASSERT_EQ(joint.start(), Fault::kNone);
    joint.tick();
    joint.data->ticks += before;
    joint.data->run_ticks += before;
    joint.data->monitor.tick += before;
    times.clear();
    double worst = 0;
    for (int i = 0; i < 3000; ++i) {
      joint.tick();
      const double t = static_cast<double>(i + 1) * period_s;
      worst = std::max(worst, std::fabs(joint.q - 0.1 * (1 - std::cos(3 * t))));
      ASSERT_EQ(joint.data->state, ControllerState::kArmed);
    }
    EXPECT_LT(worst, 0.002) << before << " ticks";
    ASSERT_EQ(times.size(), 3000U);
    for (std::size_t i = 1; i < times.size(); ++i) {
      ASSERT_NEAR(times[i] - times[i - 1], period_s, 1e-7) << before << " ticks, " << i;
    }
    EXPECT_NEAR(joint.data->output.time_s - origin_s, 3.0, 0.002);
    EXPECT_FALSE(joint.data->output.detector.latched);
  }
}

TEST(LongRun, ADetectionAfterAYearHasItsTick) {
  JointOnDesk joint;
  ASSERT_EQ(joint.start(), Fault::kNone);
  joint.ticks(1500);
  joint.data->monitor.tick += kYear;
  joint.push_nm = 30;
  joint.ticks(500);
  const auto& detector = joint.data->output.detector;
  ASSERT_TRUE(detector.latched);
  EXPECT_GT(detector.detection_tick, kYear);
  EXPECT_NEAR(detector.detection_time_s,
              static_cast<double>(detector.detection_tick) *
                  static_cast<double>(JointOnDesk::config().monitor.estimator.period_s),
              1e-6);
}

// The numbers on the wire go on over the wrap of theirs and of the 32 bits behind them, and a
// heartbeat is never later than ten ticks.
TEST(LongRun, HeartbeatsGoOnOverTheirWrap) {
  JointOnDesk joint;
  joint.ticks(3);
  joint.data->ticks = (1ULL << 32U) - 30;
  std::uint64_t last = joint.data->ticks;
  for (int i = 0; i < 60; ++i) {
    joint.tick();
    const hal::Heartbeat& said = joint.drive.heartbeat;
    EXPECT_EQ(said.ticks, static_cast<std::uint32_t>(joint.data->ticks));
    hal::Record record{};
    ASSERT_EQ(encode(said, 0, 0, record), hal::Status::kOk);
    hal::Heartbeat heard;
    std::uint8_t counter = 0;
    ASSERT_EQ(hal::decode(record, 0, heard, counter), hal::Status::kOk);
    EXPECT_EQ(heard.ticks, joint.data->ticks % (1U << 24U));
    if (said.ticks % hal::kHeartbeatTicks != 0) continue;
    EXPECT_LE(joint.data->ticks - last, hal::kHeartbeatTicks + (i < 10 ? 10 : 0));
    last = joint.data->ticks;
  }
}

// A bus whose stamps are hours ahead.
struct AheadBus {
  mutable hal::InProcessNet<2>::Port port;
  hal::Microseconds ahead_us;

  [[nodiscard]] hal::Microseconds now() const { return port.now(); }
  hal::Status send(const hal::Frame& frame, hal::Microseconds deadline_us) {
    return port.send(frame, deadline_us);
  }
  std::size_t receive(std::span<hal::ReceivedFrame> frames) {
    const std::size_t count = port.receive(frames);
    for (std::size_t i = 0; i < count; ++i) frames[i].time_us += ahead_us;
    return count;
  }
  void drop_pending() { port.drop_pending(); }
  [[nodiscard]] hal::BusState state() const { return port.state(); }
};

// GIVEN stamps that are an hour ahead WHEN the encoder falls silent THEN that is seen at the third
// tick, as ever.
TEST(Stamps, OfTheFutureKeepNoSilentEncoderAlive) {
  using Controller = JointOnDesk::Controller;
  Controller controller;
  ASSERT_EQ(Controller::create(JointOnDesk::config(), controller), Status::kOk);
  hal::InProcessNet<2> net;
  AheadBus bus{net.port(0), 3'600'000'000};
  auto joint = net.port(1);
  hal::ProtectedDrives<1> drives({.max_age_us = 2500}, {.max_age_us = 2500},
                                 hal::FrameFormat::kClassic);
  const auto data = std::make_unique<Controller::Data>();
  const auto reference = [](double) { return Reference<1, float>{}; };
  std::uint8_t counter = 0;
  const auto tick = [&](bool speaks) {
    net.set_time(net.now() + 1000);
    ++counter;
    using hal::MessageKind;
    hal::Record record{};
    if (speaks) {
      ASSERT_EQ(encode(hal::EncoderReading{0, 0, true}, counter,
                       data_id_of(MessageKind::kEncoder, 0), record),
                hal::Status::kOk);
      ASSERT_EQ(joint.send(frame_of(MessageKind::kEncoder, 0, record), net.now()),
                hal::Status::kOk);
    }
    ASSERT_EQ(encode(hal::DriveStatus{data->commands[0].mode, 0, 0}, counter,
                     data_id_of(MessageKind::kDriveStatus, 0), record),
              hal::Status::kOk);
    ASSERT_EQ(joint.send(frame_of(MessageKind::kDriveStatus, 0, record), net.now()),
              hal::Status::kOk);
    controller.step(net.now(), 0, reference, bus, drives, *data);
  };
  for (int i = 0; i < 10; ++i) tick(true);
  ASSERT_EQ(data->state, ControllerState::kPassive);
  ASSERT_EQ(controller.arm(reference, *data), Fault::kNone);
  for (int i = 0; i < 10; ++i) tick(true);
  ASSERT_EQ(data->state, ControllerState::kArmed);
  for (int i = 0; i < 3; ++i) tick(false);
  EXPECT_EQ(data->fault, Fault::kEncoderSilent);
  EXPECT_EQ(data->commands[0].mode, hal::DriveMode::kOff);
}

}  // namespace
}  // namespace offnominal::test
