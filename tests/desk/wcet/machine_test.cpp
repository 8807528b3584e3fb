#include "wcet/machine.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <unistd.h>

#include <filesystem>
#include <limits>
#include <string>
#include <thread>

#include "common/error.hpp"
#include "desk/support/temporary_folder.hpp"

namespace offnominal::desk::wcet {
namespace {

void put_file(const test::TemporaryFolder& root, const std::string& name, const std::string& text) {
  const std::filesystem::path path = root / name;
  std::filesystem::create_directories(path.parent_path());
  test::put(path, text);
}

TEST(Machine, ReadsWhatTheKernelSaysOfItself) {
  const test::TemporaryFolder root;
  put_file(root, "proc/cpuinfo",
           "processor\t: 0\nmodel name\t: Fast 9000\nflags\t\t: fpu sse2 hypervisor\n");
  put_file(root, "proc/sys/kernel/osrelease", "6.1.0-rt\n");
  put_file(root, "proc/sys/kernel/version", "#1 SMP PREEMPT_DYNAMIC Debian 6.1.1 (2023)\n");
  put_file(root, "proc/self/status", "Name:\tx\nVmLck:\t    1234 kB\n");
  put_file(root, "sys/devices/system/clocksource/clocksource0/current_clocksource", "tsc\n");
  put_file(root, "sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "performance\n");
  const Machine machine = describe_machine(root.path());
  EXPECT_EQ(machine.cpu_model, "Fast 9000");
  EXPECT_TRUE(machine.virtual_machine);
  EXPECT_EQ(machine.kernel, "6.1.0-rt");
  EXPECT_EQ(machine.preemption, "PREEMPT_DYNAMIC");
  EXPECT_TRUE(machine.memory_locked);
  EXPECT_EQ(machine.clocksource, "tsc");
  if (machine.cpu.value_or(0) == 0) {
    EXPECT_EQ(machine.governor, "performance");
  }
}

TEST(Machine, KnowsAKernelWithPreemptRtAndAnUnlockedProcess) {
  const test::TemporaryFolder root;
  put_file(root, "sys/kernel/realtime", "1\n");
  put_file(root, "proc/self/status", "VmLck:\t       0 kB\n");
  const Machine machine = describe_machine(root.path());
  EXPECT_EQ(machine.preemption, "PREEMPT_RT");
  EXPECT_FALSE(machine.memory_locked);
  EXPECT_EQ(machine.governor, "none shown");
  EXPECT_FALSE(machine.virtual_machine);
}

TEST(Machine, FindsACpuInAListAsTheKernelWritesIt) {
  EXPECT_TRUE(lists_cpu("2", 2));
  EXPECT_TRUE(lists_cpu("0,2-5,9", 4));
  EXPECT_TRUE(lists_cpu("0,2-5,9", 9));
  EXPECT_FALSE(lists_cpu("0,2-5,9", 1));
  EXPECT_FALSE(lists_cpu("0,2-5,9", 6));
  EXPECT_FALSE(lists_cpu("", 0));
}

TEST(Machine, BindsToTheCpuThatWasAskedForAndRefusesOneThatIsNone) {
  cpu_set_t before;
  ASSERT_EQ(sched_getaffinity(0, sizeof before, &before), 0);
  int cpu = 0;
  while (!CPU_ISSET(static_cast<std::size_t>(cpu), &before)) ++cpu;
  EXPECT_TRUE(
      prepare_machine({.priority = {}, .cpu = cpu, .lock_memory = false, .flush_subnormals = false})
          .empty());
  EXPECT_EQ(describe_machine().cpu, cpu);
  EXPECT_THROW(
      static_cast<void>(prepare_machine(
          {.priority = {}, .cpu = CPU_SETSIZE, .lock_memory = false, .flush_subnormals = false})),
      InputError);
  EXPECT_EQ(sched_setaffinity(0, sizeof before, &before), 0);
}

// In a thread of its own: the bits stay set for the thread that asked.
TEST(Machine, FlushesSubnormalNumbersWhenAskedTo) {
#if defined(__x86_64__)
  std::thread([] {
    volatile float tiny = std::numeric_limits<float>::min();
    volatile const float half = 0.5F;
    EXPECT_FALSE(describe_machine().subnormals_flushed);
    EXPECT_GT(tiny * half, 0.0F);
    EXPECT_TRUE(
        prepare_machine({.priority = {}, .cpu = {}, .lock_memory = false, .flush_subnormals = true})
            .empty());
    EXPECT_TRUE(describe_machine().subnormals_flushed);
    EXPECT_EQ(tiny * half, 0.0F);
  }).join();
#else
  GTEST_SKIP() << "not known for this processor";
#endif
}

TEST(Machine, ReadsTheTimeThatTheHypervisorTook) {
  const test::TemporaryFolder root;
  put_file(root, "proc/stat", "cpu  1 2 3 4 5 6 7 800 9 10\ncpu0 1 1 1 1 1 1 1 1 1 1\n");
  const Interference now = interference(root.path());
  EXPECT_DOUBLE_EQ(now.stolen_s, 800.0 / static_cast<double>(sysconf(_SC_CLK_TCK)));
  const Interference difference = Interference{5, 7, 1.5} - Interference{2, 3, 0.5};
  EXPECT_EQ(difference.involuntary_switches, 3);
  EXPECT_EQ(difference.page_faults, 4);
  EXPECT_DOUBLE_EQ(difference.stolen_s, 1.0);
}

}  // namespace
}  // namespace offnominal::desk::wcet
