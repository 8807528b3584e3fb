#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

// What the machine gives to a measurement: what was asked of it, what it says of itself, and how
// often it interfered.

namespace offnominal::desk::wcet {

struct MachineRequest {
  std::optional<int> priority;  // of SCHED_FIFO, 1 to 99; none: the scheduler stays as it is
  std::optional<int> cpu;       // to stay on; none: wherever the scheduler puts it
  bool lock_memory = true;
  bool flush_subnormals = false;  // the processor takes and gives 0 in their place
};

/// Asks the kernel. Returns a line for each thing that it refused, with what would mend it. Throws
/// InputError for a CPU that is not there.
[[nodiscard]] std::vector<std::string> prepare_machine(const MachineRequest& request);

struct Machine {
  std::string cpu_model;
  std::string kernel;      // release
  std::string preemption;  // the kernel's model: "PREEMPT_RT", "PREEMPT_DYNAMIC", ...; "none shown"
  std::string scheduler;   // class of this thread, with its priority: "SCHED_FIFO 80"
  bool memory_locked = false;
  bool subnormals_flushed = false;
  std::optional<int> cpu;  // the one that this thread is bound to
  bool cpu_isolated = false;
  std::string governor;     // of the frequency; "none shown" where the kernel tells none
  std::string clocksource;  // of the kernel's clock
  bool virtual_machine = false;
};

/// Reads /proc and /sys below `root`; scheduler and binding are those of the calling thread.
[[nodiscard]] Machine describe_machine(const std::filesystem::path& root = "/");

/// Whether a list of CPUs as the kernel writes it ("0,2-5") holds `cpu`.
[[nodiscard]] bool lists_cpu(const std::string& list, int cpu);

/// What happened to this thread since it began.
struct Interference {
  std::int64_t involuntary_switches = 0;  // it was ready, and another one ran
  std::int64_t page_faults = 0;           // with and without the disk
  double stolen_s = 0;                    // by the hypervisor, of all CPUs together
};
[[nodiscard]] Interference interference(const std::filesystem::path& root = "/");
[[nodiscard]] Interference operator-(const Interference& a, const Interference& b);

}  // namespace offnominal::desk::wcet
