#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "report/page.hpp"
#include "wcet/campaign.hpp"

// A measurement for people and programs. All times that people see are in us.

namespace offnominal::desk::wcet {

[[nodiscard]] inline double in_us(double ns) { return ns / 1000; }
[[nodiscard]] inline double in_us(std::int64_t ns) { return static_cast<double>(ns) / 1000; }

[[nodiscard]] std::string text_of(const WcetResult& result);
[[nodiscard]] nlohmann::ordered_json to_json(const WcetResult& result);
[[nodiscard]] report::Page page_of(const WcetResult& result, const std::string& command_line);

/// The histogram with a bar for each bin, bins and bars on logarithmic axes.
[[nodiscard]] std::string bars_of(const Histogram& histogram);

/// The quantiles that every table shows.
struct Quantile {
  const char* name;
  double p;
};
inline constexpr std::array<Quantile, 4> kQuantiles{
    {{"p50", 0.5}, {"p99", 0.99}, {"p99.9", 0.999}, {"p99.9999", 0.999999}}};

/// A row of the table of times.
struct TimeRow {
  std::string name;
  const Histogram* histogram;
  const Timing* timing;  // null: overruns are not counted
};
[[nodiscard]] std::vector<TimeRow> time_rows(const WcetResult& result);

struct Fact {
  std::string name;
  std::string value;
};
[[nodiscard]] std::vector<Fact> machine_facts(const WcetResult& result);
/// What the worst input was.
[[nodiscard]] std::vector<Fact> input_facts(const WcetResult& result);

/// One sentence on what was measured, and one on what lies beyond it.
[[nodiscard]] std::string measured_words(const WcetResult& result);
[[nodiscard]] std::string extrapolated_words(const WcetResult& result);

}  // namespace offnominal::desk::wcet
