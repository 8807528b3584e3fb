#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "arm_outcome.hpp"
#include "benchmark/benchmark_file.hpp"
#include "outcome.hpp"

namespace offnominal::bench {

// What --results and --write ask for.
struct ResultsRequest {
  std::string file;     // of the results; empty: none
  std::string cases;    // folder that gets the cases beside them; empty: none
  std::string command;  // that repeats the benchmark
  std::uint64_t seed = 0;
  bool force = false;
};

// Before a run: throws desk::InputError where its results could not be written in the end.
void check_results(const ResultsRequest& request);

// Both for `offnominal studio --benchmark`; `outcomes`: per group and case. Writes the cases first.
// Throws desk::InputError where something cannot be written.
void write_results(const ResultsRequest& request, const std::vector<CaseGroup>& groups,
                   const std::vector<std::vector<Outcome>>& outcomes);
void write_results(const ResultsRequest& request, const std::vector<ArmGroup>& groups,
                   const std::vector<std::vector<ArmOutcome>>& outcomes);

}  // namespace offnominal::bench
