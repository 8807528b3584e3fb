#pragma once

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

namespace offnominal::bench {

// Google Benchmark's console output, and after it one table: every benchmark's median time, its
// ratio to a reference benchmark of the same run, and its heap calls per iteration.
class RatioReporter : public benchmark::ConsoleReporter {
 public:
  // Benchmarks whose name ends in a suffix are compared with the reference of that suffix.
  struct Reference {
    std::string suffix;
    std::string name;
  };
  explicit RatioReporter(std::vector<Reference> references);

  void ReportRuns(const std::vector<Run>& runs) override;
  void print_table() const;

 private:
  struct Row {
    std::string name;
    double time_ns;
    double heap_calls;
  };
  std::vector<Reference> references_;
  std::vector<Row> medians_;
};

}  // namespace offnominal::bench
