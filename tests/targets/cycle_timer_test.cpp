#include <gtest/gtest.h>

#include <offnominal/realtime/cycle_timer.hpp>

namespace offnominal::realtime {
namespace {

TEST(CycleTimer, TicksAreDueAtMultiplesOfThePeriodAndThePhase) {
  CycleTimer timer(5000, 1000);
  for (int i = 0; i < 5; ++i) {
    const Tick tick = timer.wait();
    EXPECT_EQ((tick.begin_us - tick.latency_us) % 5000, 1000);
    EXPECT_GE(tick.latency_us, 0);
    EXPECT_LT(tick.latency_us, 5000);
  }
}

// GIVEN work that takes longer than its period WHEN it waits for the next tick THEN those that have
// passed are left out and counted, and the next is on the grid again.
TEST(CycleTimer, LeavesOutWhatHasPassed) {
  CycleTimer timer(5000);
  const Tick first = timer.wait();
  const Microseconds due_us = first.begin_us - first.latency_us;
  sleep_until_us(due_us + 17'000);
  const Tick next = timer.wait();
  EXPECT_GE(next.late_ticks, 2U);
  // Every period since the first is either this tick or one that was left out.
  EXPECT_EQ(next.begin_us - next.latency_us, due_us + 5000 * (1 + Microseconds{next.late_ticks}));
  const Tick after = timer.wait();
  EXPECT_GT(after.begin_us, next.begin_us);
  EXPECT_EQ((after.begin_us - after.latency_us) % 5000, 0);
}

}  // namespace
}  // namespace offnominal::realtime
