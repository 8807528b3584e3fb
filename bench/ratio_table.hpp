#pragma once

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

namespace offnominal::bench {

// Google Benchmark's console output, and after it one table: every benchmark's median time, its
// ratio to a reference benchmark of the same run, and its heap calls per iteration. Before it, how
// the measured code was built; without optimisation it is not measured, exit code 2. The library's
// own words are about itself: Debian builds it with -O2 and with its assertions, and calls that
// DEBUG. The loop that is timed is inline in its header, hence built as the measured code is.
class RatioReporter : public benchmark::ConsoleReporter {
 public:
  // Benchmarks whose name ends in a suffix are compared with the reference of that suffix.
  struct Reference {
    std::string suffix;
    std::string name;
  };
  explicit RatioReporter(std::vector<Reference> references);

  bool ReportContext(const Context& context) override;
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
