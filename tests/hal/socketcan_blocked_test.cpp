#include <set>

#include "socketcan_support.hpp"

// can0 and can1 are two controllers on one bus. A plug in front of can0's driver holds its frames
// in the kernel, as a bus does that gives way to nobody.

namespace offnominal::hal {
namespace {

using test::RawCan;

class BlockedBus : public ::testing::Test {
 protected:
  void TearDown() override {
    if (std::system("tc qdisc del dev can0 root 2>/dev/null") != 0) return;
  }
  static void block() { run_command("tc qdisc add dev can0 root plug limit 100000"); }
  static void free() { run_command("tc qdisc change dev can0 root plug release_indefinite"); }

  // 1000 torque frames at 1 kHz, each with 5 ms to live: one second.
  static void send_for_a_second(SocketCan& bus) {
    Microseconds next_us = bus.now();
    std::array<ReceivedFrame, 8> frames;
    for (int tick = 0; tick < 1000; ++tick) {
      static_cast<void>(bus.receive(frames));
      static_cast<void>(bus.send(classic(0x123, {tick / 256, tick % 256}), bus.now() + 5'000));
      next_us += 1'000;
      std::this_thread::sleep_for(std::chrono::microseconds{next_us - bus.now()});
    }
    std::this_thread::sleep_for(std::chrono::milliseconds{6});
    static_cast<void>(bus.receive(frames));
  }

  // Every frame that the other controller sees until the one with this identifier.
  static std::vector<canid_t> seen_until(const RawCan& node, canid_t last) {
    std::vector<canid_t> seen;
    while (const auto found = node.receive()) {
      seen.push_back(found->frame.can_id);
      if (found->frame.can_id == last) break;
    }
    return seen;
  }
};

TEST_F(BlockedBus, GivenFreeBusThenTheDriversWordMakesFramesSent) {
  SocketCan bus;
  open_or_fail(bus, {.interface = "can0"});
  ASSERT_TRUE(becomes(bus, BusMode::kActive));
  const RawCan node("can1");
  for (int i = 0; i < 50; ++i) {
    ASSERT_EQ(
        bus.send(classic(0x100 + static_cast<std::uint32_t>(i), {i}), bus.now() + 5 * kSecond),
        Status::kOk);
  }
  std::array<ReceivedFrame, 8> frames;
  const Microseconds end_us = bus.now() + 5 * kSecond;
  while (bus.state().sent < 50 && bus.now() < end_us) static_cast<void>(bus.receive(frames));
  EXPECT_EQ(bus.state().sent, 50U);
  std::set<canid_t> seen;
  for (int i = 0; i < 50; ++i) {
    const auto found = node.receive();
    ASSERT_TRUE(found.has_value());
    seen.insert(found->frame.can_id);
  }
  EXPECT_EQ(seen.size(), 50U);
  EXPECT_EQ(bus.state().late + bus.state().dropped, 0U);
}

TEST_F(BlockedBus, GivenOneSecondAtOneKilohertzWhenFreedThenNoOldFrameIsSeen) {
  SocketCan bus;
  open_or_fail(bus, {.interface = "can0"});
  ASSERT_TRUE(becomes(bus, BusMode::kActive));
  ASSERT_TRUE(bus.can_take_back());
  const RawCan node("can1");
  block();
  send_for_a_second(bus);
  // The last restart takes the kernel its time.
  ASSERT_TRUE(becomes(bus, BusMode::kActive));
  free();
  ASSERT_EQ(bus.send(classic(0x7F0, {}), bus.now() + 5 * kSecond), Status::kOk);
  EXPECT_EQ(seen_until(node, 0x7F0), std::vector<canid_t>{0x7F0});
  EXPECT_EQ(bus.state().sent + bus.sent_late(), 0U);
  EXPECT_GT(bus.state().late, 0U);
}

TEST_F(BlockedBus, GivenNoPermissionToRestartWhenFreedThenOnlyWhatTheKernelHeldIsSeenAndCounted) {
  SocketCan bus;
  open_or_fail(bus, {.interface = "can0", .in_kernel = 1, .may_restart_interface = false});
  ASSERT_TRUE(becomes(bus, BusMode::kActive));
  const RawCan node("can1");
  block();
  send_for_a_second(bus);
  free();
  ASSERT_EQ(bus.send(classic(0x7F0, {}), bus.now() + 5 * kSecond), Status::kOk);
  std::array<ReceivedFrame, 8> frames;
  const Microseconds end_us = bus.now() + 5 * kSecond;
  while (bus.state().sent < 2 && bus.now() < end_us) static_cast<void>(bus.receive(frames));
  EXPECT_EQ(seen_until(node, 0x7F0), (std::vector<canid_t>{0x123, 0x7F0}));
  EXPECT_EQ(bus.sent_late(), 1U);
  EXPECT_EQ(bus.state().sent, 2U);
  EXPECT_EQ(bus.state().late + bus.state().dropped, 1000U);
}

// As after an emergency stop: long before the deadline.
TEST_F(BlockedBus, GivenPendingFramesWhenTheyAreDroppedThenNoneIsSeenAndTheNextOneIs) {
  SocketCan bus;
  open_or_fail(bus, {.interface = "can0"});
  ASSERT_TRUE(becomes(bus, BusMode::kActive));
  const RawCan node("can1");
  block();
  for (std::uint32_t id = 1; id <= 20; ++id) {
    ASSERT_EQ(bus.send(classic(id, {}), bus.now() + 60 * kSecond), Status::kOk);
  }
  bus.drop_pending();
  EXPECT_EQ(bus.state().dropped, 20U);
  ASSERT_TRUE(becomes(bus, BusMode::kActive));
  free();
  ASSERT_EQ(bus.send(classic(0x7F0, {}), bus.now() + 5 * kSecond), Status::kOk);
  EXPECT_EQ(seen_until(node, 0x7F0), std::vector<canid_t>{0x7F0});
}

TEST_F(BlockedBus, GivenClassicControllerWhenCanFdFrameIsSentThenItIsRefused) {
  SocketCan bus;
  open_or_fail(bus, {.interface = "can0"});
  Frame frame = classic(1, {1});
  frame.fd = true;
  EXPECT_EQ(bus.send(frame, bus.now() + kSecond), Status::kFrameNotSupported);
}

}  // namespace
}  // namespace offnominal::hal
