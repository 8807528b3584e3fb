// The loop's tick, with everything in it, and the heap.
#include <gtest/gtest.h>

#include "desk/support/temporary_folder.hpp"
#include "heap_counter.hpp"
#include "loop_on_bus.hpp"

namespace offnominal::test {
namespace {

// GIVEN an armed controller whose frames and ticks are recorded WHEN it runs, also with an arm that
// has a fault to learn and through its safe state, THEN the heap is not used by any thread.
TEST(ControlLoopHeap, ATickDoesNotUseTheHeap) {
  const TemporaryFolder folder;
  LoopOnBus loop;
  ASSERT_EQ(loop.recorder.open({.candump = folder / "run.log",
                                .interface = "vcan0",
                                .csv = folder / "run.csv",
                                .columns = realtime::loop_columns(2)}),
            0);
  std::uint64_t first = 0;
  std::uint64_t last = 0;
  loop.timer.before_tick = [&](int tick) {
    if (tick == 20) first = bench::heap_calls();
    if (tick == 800) loop.panel.arm.store(true);
    loop.timer.plant_runs = tick < 1500;
    if (tick == 2000) last = bench::heap_calls();
    if (tick == 2000) loop.panel.end.store(true);
  };
  const realtime::LoopReport report = loop.run({.arm_when_passive = true});
  EXPECT_EQ(report.fault, controller::Fault::kEncoderSilent);
  EXPECT_GT(first, 0U);
  EXPECT_EQ(last - first, 0U);
}

}  // namespace
}  // namespace offnominal::test
