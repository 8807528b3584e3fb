#include "heap_counter.hpp"
#include "socketcan_support.hpp"

namespace offnominal::hal {
namespace {

TEST(SocketCanHeap, GivenOpenBusWhenItSendsReceivesAndDropsThenTheHeapIsNotUsed) {
  SocketCan bus;
  SocketCan other;
  open_or_fail(bus, {.interface = "vcan0"});
  open_or_fail(other, {.interface = "vcan0"});
  const Frame frame = classic(0x123, {1, 2, 3});
  std::array<ReceivedFrame, 8> frames;
  std::size_t got = 0;
  bool taken = true;
  const std::uint64_t before = bench::heap_calls();
  for (int i = 0; i < 1000; ++i) {
    taken = taken && bus.send(frame, bus.now() + kSecond) == Status::kOk;
    got += other.receive(frames) + bus.receive(frames);
    bus.drop_pending();
  }
  const std::uint64_t calls = bench::heap_calls() - before;
  EXPECT_EQ(calls, 0U);
  EXPECT_TRUE(taken);
  EXPECT_EQ(got, 1000U);
}

}  // namespace
}  // namespace offnominal::hal
