#include "wcet/machine.hpp"

#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstddef>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>

#include "common/error.hpp"

namespace offnominal::desk::wcet {
namespace {

constexpr const char* kNotShown = "none shown";

std::string reason_of(int error) { return std::generic_category().message(error); }

// The first line; empty where there is no such file.
std::string line_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line;
}

// The text behind the first colon of the line that begins with `key`.
std::string value_of(const std::filesystem::path& file, std::string_view key) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (!line.starts_with(key)) continue;
    const auto at = line.find(':');
    const auto begin = at == std::string::npos ? at : line.find_first_not_of(" \t", at + 1);
    return begin == std::string::npos ? "" : line.substr(begin);
  }
  return "";
}

std::string scheduler_words() {
  const int policy = ::sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
  sched_param parameter{};
  ::sched_getparam(0, &parameter);
  const std::string priority = " " + std::to_string(parameter.sched_priority);
  switch (policy) {
    case SCHED_FIFO:
      return "SCHED_FIFO" + priority;
    case SCHED_RR:
      return "SCHED_RR" + priority;
    case SCHED_BATCH:
      return "SCHED_BATCH";
    case SCHED_IDLE:
      return "SCHED_IDLE";
    case SCHED_OTHER:
      return "SCHED_OTHER";
    default:
      return "policy " + std::to_string(policy);
  }
}

std::optional<int> bound_cpu() {
  cpu_set_t set;
  if (::sched_getaffinity(0, sizeof set, &set) != 0 || CPU_COUNT(&set) != 1) return std::nullopt;
  std::size_t cpu = 0;
  while (!CPU_ISSET(cpu, &set)) ++cpu;
  return static_cast<int>(cpu);
}

// Bits of the SSE control register: results (FTZ) and operands (DAZ).
#if defined(__x86_64__)
constexpr bool kCanFlushSubnormals = true;
constexpr unsigned kFlushBits = 0x8040;
bool subnormals_flushed() { return (__builtin_ia32_stmxcsr() & kFlushBits) == kFlushBits; }
void flush_subnormals() { __builtin_ia32_ldmxcsr(__builtin_ia32_stmxcsr() | kFlushBits); }
#else
constexpr bool kCanFlushSubnormals = false;
bool subnormals_flushed() { return false; }
void flush_subnormals() {}
#endif

std::string preemption_of(const std::filesystem::path& root) {
  if (line_of(root / "sys/kernel/realtime") == "1") return "PREEMPT_RT";
  std::istringstream words(line_of(root / "proc/sys/kernel/version"));
  for (std::string word; words >> word;) {
    if (word.starts_with("PREEMPT")) return word;
  }
  return kNotShown;
}

void bind(int cpu) {
  cpu_set_t set;
  CPU_ZERO(&set);
  const bool possible = cpu >= 0 && cpu < CPU_SETSIZE;
  if (possible) CPU_SET(static_cast<std::size_t>(cpu), &set);
  if (possible && ::sched_setaffinity(0, sizeof set, &set) == 0) return;
  throw InputError({.file = "offnominal-wcet",
                    .place = "--cpu",
                    .found = std::to_string(cpu),
                    .allowed = "a CPU that this process may use",
                    .mend = "`taskset -p $$` shows them"});
}

}  // namespace

std::vector<std::string> prepare_machine(const MachineRequest& request) {
  std::vector<std::string> refused;
  if (request.cpu) bind(*request.cpu);
  if (request.flush_subnormals) flush_subnormals();
  if (request.flush_subnormals && !kCanFlushSubnormals) {
    refused.emplace_back("subnormal numbers are not flushed: not known for this processor");
  }
  if (request.lock_memory && ::mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    refused.push_back("memory is not locked (" + reason_of(errno) +
                      "): raise `ulimit -l`, or run as root");
  }
  if (request.priority) {
    sched_param parameter{};
    parameter.sched_priority = *request.priority;
    if (::sched_setscheduler(0, SCHED_FIFO, &parameter) != 0) {
      refused.push_back("no SCHED_FIFO (" + reason_of(errno) +
                        "): raise `ulimit -r`, or run as root");
    }
  }
  return refused;
}

bool lists_cpu(const std::string& list, int cpu) {
  std::istringstream parts(list);
  for (std::string part; std::getline(parts, part, ',');) {
    int first = 0;
    const char* end = part.data() + part.size();
    auto read = std::from_chars(part.data(), end, first);
    if (read.ec != std::errc{}) continue;
    int last = first;
    if (read.ptr != end && *read.ptr == '-') std::from_chars(read.ptr + 1, end, last);
    if (cpu >= first && cpu <= last) return true;
  }
  return false;
}

Machine describe_machine(const std::filesystem::path& root) {
  Machine machine;
  machine.cpu_model = value_of(root / "proc/cpuinfo", "model name");
  machine.kernel = line_of(root / "proc/sys/kernel/osrelease");
  machine.preemption = preemption_of(root);
  machine.scheduler = scheduler_words();
  const std::string locked = value_of(root / "proc/self/status", "VmLck");
  machine.memory_locked = !locked.empty() && !locked.starts_with("0 ");
  machine.subnormals_flushed = subnormals_flushed();
  machine.cpu = bound_cpu();
  const std::filesystem::path cpus = root / "sys/devices/system/cpu";
  if (machine.cpu) {
    machine.cpu_isolated = lists_cpu(line_of(cpus / "isolated"), *machine.cpu);
  }
  const std::string frequency = "cpu" + std::to_string(machine.cpu.value_or(0)) + "/cpufreq";
  machine.governor = line_of(cpus / frequency / "scaling_governor");
  if (machine.governor.empty()) machine.governor = kNotShown;
  machine.clocksource =
      line_of(root / "sys/devices/system/clocksource/clocksource0/current_clocksource");
  const std::string flags = " " + value_of(root / "proc/cpuinfo", "flags") + " ";
  machine.virtual_machine = flags.find(" hypervisor ") != std::string::npos;
  return machine;
}

Interference interference(const std::filesystem::path& root) {
  Interference now;
  rusage usage{};
  if (::getrusage(RUSAGE_THREAD, &usage) == 0) {
    now.involuntary_switches = usage.ru_nivcsw;
    now.page_faults = usage.ru_minflt + usage.ru_majflt;
  }
  std::istringstream all(line_of(root / "proc/stat"));
  std::string name;
  double ticks = 0;
  all >> name;
  // user nice system idle iowait irq softirq steal
  for (int i = 0; i < 8 && all >> ticks; ++i) {
    if (i == 7) now.stolen_s = ticks / static_cast<double>(::sysconf(_SC_CLK_TCK));
  }
  return now;
}

Interference operator-(const Interference& a, const Interference& b) {
  return {a.involuntary_switches - b.involuntary_switches, a.page_faults - b.page_faults,
          a.stolen_s - b.stolen_s};
}

}  // namespace offnominal::desk::wcet
