#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <string>

#include "support/raw_can.hpp"

namespace {

using offnominal::test::raw_fd_frame;
using offnominal::test::raw_frame;
using offnominal::test::RawCan;
using offnominal::test::RawFrame;

void expect_passes(const RawCan& from, const RawCan& to, const RawFrame& sent) {
  ASSERT_TRUE(from.send(sent)) << std::strerror(errno);
  const auto found = to.receive();
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->size, sent.size);
  EXPECT_EQ(found->frame.can_id, sent.frame.can_id);
  ASSERT_EQ(found->frame.len, sent.frame.len);
  EXPECT_EQ(std::memcmp(found->frame.data, sent.frame.data, sent.frame.len), 0);
}

TEST(Buses, GivenVirtualBusWhenFramesOfEitherKindAreSentThenTheyArriveAsTheyWere) {
  const RawCan from("vcan0");
  const RawCan to("vcan0");
  expect_passes(from, to, raw_frame(0x123, {1, 2, 3, 4, 5, 6, 7, 8}));
  expect_passes(from, to, raw_frame(0x1ABCDEF0U | CAN_EFF_FLAG, {}));
  expect_passes(from, to, raw_fd_frame(0x7FF, 64, 0xA5));
}

TEST(Buses, GivenTwoVirtualBusesWhenFrameIsSentOnOneThenTheOtherStaysQuiet) {
  const RawCan from("vcan0");
  const RawCan same("vcan0");
  const RawCan other("vcan1");
  expect_passes(from, same, raw_frame(0x1, {1}));
  EXPECT_FALSE(other.receive(std::chrono::milliseconds{0}).has_value());
}

TEST(Buses, GivenTwoControllersOnOneBusWhenEitherSendsThenTheOtherReceives) {
  const RawCan first("can0");
  const RawCan second("can1");
  expect_passes(first, second, raw_frame(0x123, {1, 2, 3, 4, 5, 6, 7, 8}));
  expect_passes(second, first, raw_frame(0x1ABCDEF0U | CAN_EFF_FLAG, {9}));
}

TEST(Buses, GivenControllersThenBothRunAtOneMegabitPerSecond) {
  for (const std::string name : {"can0", "can1"}) {
    const std::string command =
        "ip -details link show dev " + name + " | grep -q ' bitrate 1000000 '";
    EXPECT_EQ(std::system(command.c_str()), 0) << name;
  }
}

// The emulated controller is one for classic CAN, as its kernel driver says.
TEST(Buses, GivenClassicControllerWhenCanFdFrameIsSentThenItIsRefused) {
  const RawCan first("can0");
  EXPECT_FALSE(first.send(raw_fd_frame(0x123, 64, 1)));
}

}  // namespace
