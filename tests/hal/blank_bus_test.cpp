#include <gtest/gtest.h>

#include <array>
#include <offnominal/hal/bus/blank_bus.hpp>

namespace offnominal::hal {
namespace {

TEST(BlankBus, IsAnInterfaceThatIsDown) {
  BlankBus bus;
  Frame frame;
  EXPECT_EQ(bus.send(frame, 0), Status::kInterfaceDown);
  frame.length = 200;
  EXPECT_EQ(bus.send(frame, 0), Status::kFrameNotSupported);
  std::array<ReceivedFrame, 4> frames;
  EXPECT_EQ(bus.receive(frames), 0U);
  EXPECT_EQ(bus.state().mode, BusMode::kDown);
}

}  // namespace
}  // namespace offnominal::hal
