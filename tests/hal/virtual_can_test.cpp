#include <net/if.h>

#include <offnominal/hal/bus/virtual_can.hpp>

#include "socketcan_support.hpp"

namespace offnominal::hal {
namespace {

TEST(VirtualCan, CarriesClassicAndFdFramesAndGoesWithItsMaker) {
  ASSERT_EQ(::if_nametoindex("vcan7"), 0U);
  {
    VirtualCan made;
    ASSERT_EQ(made.make("vcan7"), Status::kOk) << std::strerror(made.error_number());
    EXPECT_TRUE(made.was_made());
    SocketCan bus;
    open_or_fail(bus, {.interface = "vcan7"});
    const test::RawCan other("vcan7");
    Frame fd = classic(0x1A0, {});
    fd.fd = true;
    fd.length = kMaxFdLength;
    ASSERT_EQ(bus.send(classic(0x123, {1, 2}), bus.now() + kSecond), Status::kOk);
    ASSERT_EQ(bus.send(fd, bus.now() + kSecond), Status::kOk);
    const auto first = other.receive();
    const auto second = other.receive();
    ASSERT_TRUE(first && second);
    EXPECT_EQ(first->frame.can_id, 0x123U);
    EXPECT_EQ(second->frame.len, kMaxFdLength);
  }
  EXPECT_EQ(::if_nametoindex("vcan7"), 0U);
}

TEST(VirtualCan, LeavesAnInterfaceThatIsThereToItsOwner) {
  const unsigned before = ::if_nametoindex("vcan0");
  ASSERT_NE(before, 0U) << "these tests run in ./dev vcan --controller, as ./dev test runs them";
  {
    VirtualCan found;
    EXPECT_EQ(found.make("vcan0"), Status::kOk);
    EXPECT_FALSE(found.was_made());
  }
  EXPECT_EQ(::if_nametoindex("vcan0"), before);
}

TEST(VirtualCan, SaysWhatIsWrongWithAName) {
  VirtualCan none;
  EXPECT_EQ(none.make("vcan-of-a-long-name"), Status::kSystemError);
  EXPECT_EQ(none.error_number(), EINVAL);
  EXPECT_EQ(none.make("v/can"), Status::kSystemError);
}

}  // namespace
}  // namespace offnominal::hal
