#include <gtest/gtest.h>

#include <memory>
#include <offnominal/realtime/spsc_ring.hpp>
#include <thread>

#include "support/repetitions.hpp"

namespace offnominal::realtime {
namespace {

TEST(SpscRing, TakesWhatItHasRoomForAndKeepsTheOrder) {
  SpscRing<int, 4> ring;
  int item = 0;
  EXPECT_FALSE(ring.pop(item));
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(ring.push(i));
  EXPECT_FALSE(ring.push(4));
  for (int i = 0; i < 4; ++i) {
    ASSERT_TRUE(ring.pop(item));
    EXPECT_EQ(item, i);
  }
  EXPECT_FALSE(ring.pop(item));
}

// GIVEN one thread that fills it and one that empties it WHEN both go as fast as they can THEN
// everything arrives whole, once and in order.
TEST(SpscRing, CarriesWholeItemsFromThreadToThread) {
  struct Item {
    long number = 0;
    long check[7] = {};
  };
  const auto ring = std::make_unique<SpscRing<Item, 64>>();
  const long count = test::repetitions(1'000'000);
  std::thread filler([&] {
    for (long i = 0; i < count;) {
      Item item{i, {i, i, i, i, i, i, i}};
      if (ring->push(item)) {
        ++i;
      } else {
        std::this_thread::yield();
      }
    }
  });
  long expected = 0;
  long torn = 0;
  while (expected < count) {
    Item item;
    if (!ring->pop(item)) {
      std::this_thread::yield();
      continue;
    }
    for (const long check : item.check) torn += check == expected ? 0 : 1;
    ASSERT_EQ(item.number, expected);
    ++expected;
  }
  filler.join();
  EXPECT_EQ(torn, 0);
}

}  // namespace
}  // namespace offnominal::realtime
