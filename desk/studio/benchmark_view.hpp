#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "benchmark/benchmark_file.hpp"
#include "studio/results_view.hpp"

namespace offnominal::desk::studio {

/// The results of `./dev bench discovery --results`, and its cases as recordings. Filters: `effect`
/// and `joint` of what was hidden, `group` of the case, and of the list `outcome`: "missed",
/// "in_class", "wrong", "failed".
class BenchmarkView final : public ResultsView {
 public:
  /// Throws InputError where the results cannot be read.
  explicit BenchmarkView(const std::string& results);

  [[nodiscard]] nlohmann::ordered_json state() const override;
  /// What became of every effect that the filter leaves, found shares over size and time.
  [[nodiscard]] nlohmann::json figures(const ResultsFilter& filter) const override;
  [[nodiscard]] nlohmann::ordered_json runs(const ResultsFilter& filter,
                                            std::size_t from) const override;
  /// The files of a case, which lie where the benchmark has written them. Throws Refused where it
  /// has not.
  [[nodiscard]] SessionFiles record(std::int64_t run) override;

 private:
  [[nodiscard]] std::vector<const benchmark::Case*> left_by(const ResultsFilter& filter) const;

  std::string results_file_;
  benchmark::Results results_;
};

}  // namespace offnominal::desk::studio
