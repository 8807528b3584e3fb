// What the CAN Simple driver asks of its configuration, and how long it believes a frame.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <offnominal/hal/protocols/can_simple/can_simple.hpp>
#include <vector>

namespace offnominal::hal {
namespace {

struct DriverSetup {
  CanSimpleConfig config;
  std::array<CanSimpleAxis, 2> axes{{{.node = 3}, {.node = 63}}};
};

ReceivedFrame encoder_frame(std::uint32_t node, Microseconds time_us) {
  ReceivedFrame received;
  received.frame.id = node << 5U | 0x09U;
  received.frame.length = 8;
  received.time_us = time_us;
  return received;
}

// GIVEN a configuration with which axes could not be told apart, or a torque would be made of
// nothing, WHEN the driver has it THEN it says why, hears nobody and tells nobody anything.
TEST(CanSimpleConfiguration, IsRefusedWithItsReason) {
  struct Case {
    Status status;
    std::function<void(DriverSetup&)> change;
  };
  const std::vector<Case> cases{
      {Status::kOk, [](DriverSetup&) {}},
      {Status::kOk, [](DriverSetup& s) { s.axes[0].node = 0; }},
      {Status::kOk, [](DriverSetup& s) { s.axes[0].joint_per_turn = -0.62832F; }},
      {Status::kOk, [](DriverSetup& s) { s.config.torque_interval_us = 1000; }},
      {Status::kInvalidNode, [](DriverSetup& s) { s.axes[1].node = 64; }},
      {Status::kInvalidNode, [](DriverSetup& s) { s.axes[1].node = 255; }},
      {Status::kInvalidNode, [](DriverSetup& s) { s.axes[1].node = 3; }},
      {Status::kInvalidScale, [](DriverSetup& s) { s.axes[1].joint_per_turn = 0; }},
      {Status::kInvalidScale, [](DriverSetup& s) { s.axes[0].joint_per_turn = INFINITY; }},
      {Status::kInvalidScale, [](DriverSetup& s) { s.axes[0].joint_per_turn = NAN; }},
      {Status::kInvalidScale, [](DriverSetup& s) { s.axes[1].motor_nm_per_ampere = NAN; }},
      {Status::kInvalidInterval, [](DriverSetup& s) { s.config.encoder_interval_us = 0; }},
      {Status::kInvalidInterval, [](DriverSetup& s) { s.config.heartbeat_interval_us = -1; }},
      {Status::kInvalidInterval, [](DriverSetup& s) { s.config.heartbeat_interval_us = 0; }},
      {Status::kInvalidInterval, [](DriverSetup& s) { s.config.torque_interval_us = -1; }},
  };
  for (std::size_t i = 0; i < cases.size(); ++i) {
    DriverSetup setup;
    cases[i].change(setup);
    EXPECT_EQ(validate(setup.config, setup.axes), cases[i].status) << i;
    CanSimpleDrives<2> drives(setup.config, setup.axes);
    EXPECT_EQ(drives.configuration(), cases[i].status) << i;
    EXPECT_EQ(drives.take(encoder_frame(setup.axes[0].node, 1000)), cases[i].status) << i;
    const bool heard = drives.feedback(0, 1000).encoder == SourceState::kValid;
    EXPECT_EQ(heard, cases[i].status == Status::kOk) << i;
    const std::array<TorqueCommand, 2> commands{};
    std::array<Frame, 4> frames;
    EXPECT_EQ(drives.outgoing(commands, {}, frames) > 0, cases[i].status == Status::kOk) << i;
  }
}

// GIVEN a stamp of the future WHEN its encoder is silent THEN it is not valid until that time
// comes.
TEST(CanSimpleStamps, OfTheFutureKeepNoSilentEncoderAlive) {
  const DriverSetup setup;
  CanSimpleDrives<2> drives(setup.config, setup.axes);
  ASSERT_EQ(drives.take(encoder_frame(3, 3'600'000'000)), Status::kOk);
  for (const Microseconds now_us : {0LL, 1'800'000'000LL, 3'599'997'499LL, 3'600'002'501LL}) {
    EXPECT_EQ(drives.feedback(0, now_us).encoder, SourceState::kStale) << now_us;
  }
  for (const Microseconds now_us : {3'599'997'500LL, 3'600'002'500LL}) {
    EXPECT_EQ(drives.feedback(0, now_us).encoder, SourceState::kValid) << now_us;
  }
}

}  // namespace
}  // namespace offnominal::hal
