#include "ratio_table.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <utility>

namespace offnominal::bench {

RatioReporter::RatioReporter(std::vector<Reference> references)
    : benchmark::ConsoleReporter(OO_Tabular), references_(std::move(references)) {}

bool RatioReporter::ReportContext(const Context& context) {
#if defined(NDEBUG) && defined(__OPTIMIZE__)
  std::printf("measured code: optimised, without assertions\n");
#else
  std::fprintf(stderr,
               "measured code: not optimised, or with assertions: its times say nothing; "
               "./dev bench builds it as they count\n");
  std::exit(2);
#endif
  const benchmark::CPUInfo& cpu = context.cpu_info;
  std::printf("%d CPUs of %.0f MHz", cpu.num_cpus, cpu.cycles_per_second * 1e-6);
  if (!cpu.load_avg.empty()) std::printf(", load %.2f", cpu.load_avg[0]);
  if (cpu.scaling == benchmark::CPUInfo::ENABLED) std::printf(", frequency scaled: times vary");
  std::printf("\n");
  name_field_width_ = context.name_field_width;
  printed_header_ = false;
  prev_counters_.clear();
  return true;
}

void RatioReporter::ReportRuns(const std::vector<Run>& runs) {
  for (const Run& run : runs) {
    if (run.run_type != Run::RT_Aggregate || run.aggregate_name != "median") continue;
    const auto heap = run.counters.find("heap_calls");
    medians_.push_back({run.run_name.function_name, run.GetAdjustedCPUTime(),
                        heap == run.counters.end() ? 0.0 : heap->second.value});
  }
  ConsoleReporter::ReportRuns(runs);
}

void RatioReporter::print_table() const {
  std::printf("\n%-44s %12s %10s %12s  %s\n", "benchmark", "median [ns]", "ratio", "heap calls",
              "ratio to");
  for (const Row& row : medians_) {
    const auto reference =
        std::find_if(references_.begin(), references_.end(),
                     [&](const Reference& r) { return row.name.ends_with(r.suffix); });
    const auto base = std::find_if(medians_.begin(), medians_.end(), [&](const Row& other) {
      return reference != references_.end() && other.name == reference->name;
    });
    std::printf("%-44s %12.1f ", row.name.c_str(), row.time_ns);
    if (base == medians_.end()) {
      std::printf("%10s %12.0f\n", "-", row.heap_calls);
    } else {
      std::printf("%10.2f %12.0f  %s\n", row.time_ns / base->time_ns, row.heap_calls,
                  base->name.c_str());
    }
  }
}

}  // namespace offnominal::bench
