#pragma once

#include <cstdint>
#include <string>

#include "results.hpp"

namespace offnominal::bench {

// What of the benchmark of arms is run, and how it is shown.
struct ArmBenchOptions {
  bool quick = false;
  bool json = false;
  bool failures = false;
  std::string cases;  // empty: all
  // Of a run; without a file of results the cases are written, where a folder is named, in place of
  // it.
  ResultsRequest results;
  int most = 1000;  // cases of each group
  std::uint64_t seed = 0;
  int threads = 1;
};

// Prints tables or JSON, or the folders that were written. Throws CLI::ValidationError for a group
// that there is not.
void run_arm_bench(const ArmBenchOptions& options);

}  // namespace offnominal::bench
