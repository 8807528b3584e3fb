#include <gtest/gtest.h>

#include <array>
#include <offnominal/hal/bus/in_process_bus.hpp>
#include <vector>

namespace offnominal::hal {
namespace {

using Net = InProcessNet<3, 8>;

Frame numbered(std::uint32_t id, std::uint8_t number) {
  Frame frame;
  frame.id = id;
  frame.length = 1;
  frame.data[0] = number;
  return frame;
}

std::vector<int> numbers_at(Net::Port port) {
  std::array<ReceivedFrame, 16> frames;
  std::vector<int> numbers;
  const std::size_t count = port.receive(frames);
  for (std::size_t i = 0; i < count; ++i) numbers.push_back(frames[i].frame.data[0]);
  return numbers;
}

TEST(InProcessBus, EveryOtherPortReceivesInTheOrderOfSending) {
  Net net;
  net.set_time(5);
  EXPECT_EQ(net.port(0).send(numbered(2, 1), 10), Status::kOk);
  EXPECT_EQ(net.port(1).send(numbered(1, 2), 10), Status::kOk);
  EXPECT_EQ(numbers_at(net.port(2)), (std::vector<int>{1, 2}));
  EXPECT_EQ(numbers_at(net.port(1)), (std::vector<int>{1}));
  EXPECT_EQ(numbers_at(net.port(0)), (std::vector<int>{2}));
  EXPECT_EQ(numbers_at(net.port(0)), std::vector<int>{});
}

TEST(InProcessBus, AFrameThatIsLateIsNotSent) {
  Net net;
  net.set_time(100);
  EXPECT_EQ(net.port(0).send(numbered(1, 1), 99), Status::kDeadlinePassed);
  EXPECT_EQ(net.port(0).state().late, 1U);
  EXPECT_EQ(numbers_at(net.port(1)), std::vector<int>{});
}

// GIVEN a bus that is blocked for a second WHEN it is free again THEN nothing old is seen.
TEST(InProcessBus, NothingOldLeavesAfterABlock) {
  Net net;
  net.set_blocked(true);
  for (int tick = 0; tick < 1000; ++tick) {
    net.set_time(1000 * tick);
    ASSERT_EQ(net.port(0).send(numbered(1, static_cast<std::uint8_t>(tick)), 1000 * tick + 900),
              Status::kOk);
    static_cast<void>(numbers_at(net.port(0)));
  }
  net.set_time(1000 * 1000);
  net.set_blocked(false);
  EXPECT_EQ(numbers_at(net.port(1)), std::vector<int>{});
  EXPECT_EQ(net.port(0).state().sent, 0U);
  EXPECT_EQ(net.port(0).state().late + net.port(0).state().dropped, 1000U);
}

TEST(InProcessBus, ANewFrameTakesThePlaceOfTheOldOneOfItsIdentifier) {
  Net net;
  net.set_blocked(true);
  EXPECT_EQ(net.port(0).send(numbered(7, 1), 100), Status::kOk);
  EXPECT_EQ(net.port(0).send(numbered(7, 2), 100), Status::kOk);
  EXPECT_EQ(net.port(0).send(numbered(6, 3), 100), Status::kOk);
  net.set_blocked(false);
  EXPECT_EQ(numbers_at(net.port(1)), (std::vector<int>{3, 2}));
  EXPECT_EQ(net.port(0).state().dropped, 1U);
}

TEST(InProcessBus, DropPendingLeavesNothingToSend) {
  Net net;
  net.set_blocked(true);
  EXPECT_EQ(net.port(0).send(numbered(7, 1), 100), Status::kOk);
  net.port(0).drop_pending();
  net.set_blocked(false);
  EXPECT_EQ(numbers_at(net.port(1)), std::vector<int>{});
}

TEST(InProcessBus, ANodeThatIsBusOffNeitherSendsNorReceives) {
  Net net;
  net.set_blocked(true);
  EXPECT_EQ(net.port(0).send(numbered(7, 1), 100), Status::kOk);
  net.set_mode(0, BusMode::kOff);
  net.set_blocked(false);
  EXPECT_EQ(net.port(0).send(numbered(7, 2), 100), Status::kBusOff);
  EXPECT_EQ(net.port(1).send(numbered(8, 3), 100), Status::kOk);
  EXPECT_EQ(numbers_at(net.port(0)), std::vector<int>{});
  EXPECT_EQ(numbers_at(net.port(2)), (std::vector<int>{3})) << "nothing of before bus-off";
  net.set_mode(0, BusMode::kActive);
  EXPECT_EQ(net.port(0).send(numbered(7, 4), 100), Status::kOk);
  EXPECT_EQ(numbers_at(net.port(2)), (std::vector<int>{4}));
}

TEST(InProcessBus, AFullQueueLosesItsOldestAndCountsIt) {
  Net net;
  for (int i = 0; i < 10; ++i) {
    ASSERT_EQ(net.port(0).send(numbered(1, static_cast<std::uint8_t>(i)), 100), Status::kOk);
  }
  EXPECT_EQ(numbers_at(net.port(1)), (std::vector<int>{2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(net.port(1).state().receive_overflow, 2U);
}

TEST(InProcessBus, AFrameThatNoBusCanCarryIsRefused) {
  Net net;
  Frame frame = numbered(0x800, 1);
  EXPECT_EQ(net.port(0).send(frame, 100), Status::kFrameNotSupported);
  frame = numbered(1, 1);
  frame.length = 9;
  EXPECT_EQ(net.port(0).send(frame, 100), Status::kFrameNotSupported);
}

TEST(InProcessBus, TimeDoesNotGoBack) {
  Net net;
  net.set_time(50);
  net.set_time(40);
  EXPECT_EQ(net.port(0).now(), 50);
}

}  // namespace
}  // namespace offnominal::hal
