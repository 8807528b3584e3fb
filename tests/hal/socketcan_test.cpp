#include <linux/can/error.h>

#include "socketcan_support.hpp"

namespace offnominal::hal {
namespace {

using test::raw_frame;
using test::RawCan;

TEST(SocketCan, GivenEveryKindOfFrameWhenSentThenItArrivesAsItWas) {
  SocketCan from;
  SocketCan to;
  open_or_fail(from, {.interface = "vcan0"});
  open_or_fail(to, {.interface = "vcan0"});
  std::vector<Frame> kinds{classic(0x7FF, {1, 2, 3, 4, 5, 6, 7, 8}), classic(0, {}),
                           classic(kMaxExtendedId, {9}), classic(0x12, {}), classic(0x13, {})};
  kinds[2].extended = true;
  kinds[3].remote = true;
  kinds[4].fd = true;
  kinds[4].length = 64;
  kinds[4].data.fill(0xA5);
  for (const Frame& sent : kinds) {
    ASSERT_EQ(from.send(sent, from.now() + kSecond), Status::kOk);
    const auto found = receive_some(to, 1);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].frame.id, sent.id);
    EXPECT_EQ(found[0].frame.extended, sent.extended);
    EXPECT_EQ(found[0].frame.fd, sent.fd);
    EXPECT_EQ(found[0].frame.remote, sent.remote);
    EXPECT_EQ(found[0].frame.length, sent.length);
    EXPECT_EQ(found[0].frame.data, sent.data);
  }
  EXPECT_EQ(receive_some(from, 0).size(), 0U);
  std::array<ReceivedFrame, 4> none;
  EXPECT_EQ(from.receive(none), 0U) << "its own frames are not handed over";
  EXPECT_EQ(from.state().sent, kinds.size());
  EXPECT_EQ(to.state().received, kinds.size());
}

TEST(SocketCan, GivenFrameThatWaitedInTheKernelWhenReceivedThenItsTimeIsWhenItCame) {
  SocketCan bus;
  open_or_fail(bus, {.interface = "vcan0"});
  const RawCan node("vcan0");
  std::array<ReceivedFrame, 1> frames;
  const Microseconds before_us = bus.now();
  ASSERT_EQ(bus.receive(frames), 0U);
  ASSERT_TRUE(node.send(raw_frame(1, {1})));
  const Microseconds after_us = bus.now();
  std::this_thread::sleep_for(std::chrono::milliseconds{200});
  ASSERT_EQ(bus.receive(frames), 1U);
  EXPECT_GE(frames[0].time_us, before_us);
  // The two clocks are read one after the other.
  EXPECT_LE(frames[0].time_us, after_us + 50'000);
}

TEST(SocketCan, GivenFiltersThenOnlyWhatTheyLetPassComesAndGoes) {
  const std::array<IdFilter, 1> wanted{{{.id = 0x100, .mask = 0x7F0}}};
  const std::array<IdFilter, 1> own{{{.id = 0x200, .mask = 0x7FF}}};
  SocketCan bus;
  open_or_fail(bus, {.interface = "vcan0", .receive = wanted, .transmit = own});
  const RawCan node("vcan0");
  ASSERT_TRUE(node.send(raw_frame(0x0FF, {1})));
  ASSERT_TRUE(node.send(raw_frame(0x200, {2})));
  ASSERT_TRUE(node.send(raw_frame(0x105 | CAN_EFF_FLAG, {3})));
  ASSERT_TRUE(node.send(raw_frame(0x105, {4})));
  const auto found = receive_some(bus, 1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].frame.data[0], 4);

  EXPECT_EQ(bus.send(classic(0x201, {}), bus.now() + kSecond), Status::kFrameNotSupported);
  EXPECT_EQ(bus.send(classic(0x200, {}), bus.now() + kSecond), Status::kOk);
  static_cast<void>(bus.receive({}));
  EXPECT_EQ(bus.state().sent, 1U);
}

// What the kernel sifts out takes no room.
TEST(SocketCan, GivenFiltersWhenTheBusIsFullOfOtherFramesThenNoneOfOursIsLost) {
  const std::array<IdFilter, 1> wanted{{{.id = 0x100, .mask = 0x7FF}}};
  SocketCan bus;
  open_or_fail(bus, {.interface = "vcan0", .receive = wanted});
  const RawCan node("vcan0");
  for (int i = 0; i < 2000; ++i) ASSERT_TRUE(node.send(raw_frame(0x101, {1})));
  ASSERT_TRUE(node.send(raw_frame(0x100, {2})));
  ASSERT_EQ(receive_some(bus, 1).size(), 1U);
  EXPECT_EQ(bus.state().receive_overflow, 0U);
}

TEST(SocketCan, GivenDeadlineThatHasPassedWhenSentThenTheFrameIsRefusedAndNobodySeesIt) {
  SocketCan bus;
  open_or_fail(bus, {.interface = "vcan0"});
  const RawCan node("vcan0");
  EXPECT_EQ(bus.send(classic(1, {1}), bus.now() - 1), Status::kDeadlinePassed);
  EXPECT_EQ(bus.send(classic(1, {2}), bus.now() + kSecond), Status::kOk);
  const auto seen = node.receive();
  ASSERT_TRUE(seen.has_value());
  EXPECT_EQ(seen->frame.data[0], 2);
  EXPECT_EQ(bus.state().late, 1U);
}

TEST(SocketCan, GivenErrorFramesOfTheControllerThenTheyAreTheMode) {
  SocketCan bus;
  open_or_fail(bus, {.interface = "vcan0"});
  const RawCan node("vcan0");
  ASSERT_TRUE(node.send(error_report(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING)));
  EXPECT_TRUE(becomes(bus, BusMode::kWarning));
  ASSERT_TRUE(node.send(error_report(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_PASSIVE)));
  EXPECT_TRUE(becomes(bus, BusMode::kPassive));
  ASSERT_TRUE(node.send(error_report(CAN_ERR_LOSTARB)));
  ASSERT_TRUE(node.send(error_report(CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE)));
  EXPECT_TRUE(becomes(bus, BusMode::kActive));
  EXPECT_EQ(bus.state().errors, 4U);
  EXPECT_EQ(bus.state().received, 0U) << "error frames are not handed over";
}

TEST(SocketCan, GivenBusOffAndNoRestartAllowedThenItSendsAgainOnlyAfterTheDriversReport) {
  SocketCan bus;
  open_or_fail(bus, {.interface = "vcan0", .may_restart_interface = false});
  EXPECT_FALSE(bus.can_take_back());
  const RawCan node("vcan0");
  ASSERT_TRUE(node.send(error_report(CAN_ERR_BUSOFF)));
  EXPECT_TRUE(becomes(bus, BusMode::kOff));
  ASSERT_TRUE(node.send(error_report(CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE)));
  static_cast<void>(receive_some(bus, 0));
  EXPECT_EQ(bus.send(classic(1, {}), bus.now() + kSecond), Status::kBusOff);
  ASSERT_TRUE(node.send(error_report(CAN_ERR_RESTARTED)));
  EXPECT_TRUE(becomes(bus, BusMode::kActive));
  EXPECT_EQ(bus.send(classic(1, {}), bus.now() + kSecond), Status::kOk);
}

TEST(SocketCan, GivenBusOffAndRestartAllowedThenItIsBackAfterThePause) {
  SocketCan bus;
  open_or_fail(bus, {.interface = "vcan0", .pause_after_restart_us = 50'000});
  ASSERT_TRUE(bus.can_take_back());
  const RawCan node("vcan0");
  ASSERT_TRUE(node.send(error_report(CAN_ERR_BUSOFF)));
  const Microseconds before_us = bus.now();
  EXPECT_TRUE(becomes(bus, BusMode::kOff));
  EXPECT_EQ(bus.send(classic(1, {}), bus.now() + kSecond), Status::kBusOff);
  EXPECT_TRUE(becomes(bus, BusMode::kActive));
  EXPECT_GE(bus.now() - before_us, 50'000);
  EXPECT_EQ(bus.send(classic(1, {}), bus.now() + kSecond), Status::kOk);
}

TEST(SocketCan, GivenInterfaceThatGoesDownThenNothingIsTakenUntilItIsUp) {
  SocketCan bus;
  open_or_fail(bus, {.interface = "vcan1"});
  run_command("ip link set vcan1 down");
  EXPECT_TRUE(becomes(bus, BusMode::kDown));
  EXPECT_EQ(bus.send(classic(1, {}), bus.now() + kSecond), Status::kInterfaceDown);
  run_command("ip link set vcan1 up");
  EXPECT_TRUE(becomes(bus, BusMode::kActive));
  EXPECT_EQ(bus.send(classic(1, {}), bus.now() + kSecond), Status::kOk);
}

TEST(SocketCan, GivenMoreFramesThanThereIsRoomForThenTheLossIsCounted) {
  SocketCan bus;
  open_or_fail(bus, {.interface = "vcan0"});
  const RawCan node("vcan0");
  constexpr std::uint32_t kSent = 2000;
  for (std::uint32_t i = 0; i < kSent; ++i) ASSERT_TRUE(node.send(raw_frame(i & 0x7FF, {1})));
  std::array<ReceivedFrame, 64> frames;
  std::uint32_t got = 0;
  while (const std::size_t count = bus.receive(frames)) got += static_cast<std::uint32_t>(count);
  EXPECT_LT(got, kSent);
  // The kernel tells of its loss with the next frame.
  ASSERT_TRUE(node.send(raw_frame(1, {1})));
  got += static_cast<std::uint32_t>(receive_some(bus, 1).size());
  EXPECT_EQ(got + bus.state().receive_overflow, kSent + 1);
}

TEST(SocketCan, GivenWrongInterfaceThenOpeningSaysSoAndTheBusIsDown) {
  SocketCan bus;
  EXPECT_EQ(bus.send(classic(1, {}), kSecond), Status::kInterfaceDown);
  for (const char* name : {"nocan0", "", "lo", "a_name_that_no_interface_can_have"}) {
    EXPECT_EQ(bus.open({.interface = name}), Status::kNoSuchInterface) << name;
    EXPECT_EQ(bus.error_number(), ENODEV) << name;
    EXPECT_EQ(bus.state().mode, BusMode::kDown);
  }
  EXPECT_EQ(bus.open({.interface = "vcan0", .in_kernel = 0}), Status::kSystemError);
}

}  // namespace
}  // namespace offnominal::hal
