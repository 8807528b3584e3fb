#pragma once

#include <cstdint>
#include <string>

namespace offnominal::bench {

// What of the benchmark of arms is run, and how it is shown.
struct ArmBenchOptions {
  bool quick = false;
  bool json = false;
  bool failures = false;
  std::string cases;  // empty: all
  std::string write;  // folder that gets the cases, in place of a run; empty: none
  int most = 1000;    // cases of each group
  std::uint64_t seed = 0;
  int threads = 1;
};

// Prints tables or JSON, or the folders that were written. Throws CLI::ValidationError for a group
// that there is not.
void run_arm_bench(const ArmBenchOptions& options);

}  // namespace offnominal::bench
