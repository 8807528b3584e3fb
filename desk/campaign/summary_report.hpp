#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "campaign/summary.hpp"
#include "report/page.hpp"

namespace offnominal::desk::campaign {

[[nodiscard]] std::string text_of(const Summary& summary);
[[nodiscard]] nlohmann::ordered_json to_json(const Summary& summary);
/// Tables, ROC curves, and the share of runs in which a fault is seen over its size.
[[nodiscard]] report::Page page_of(const Summary& summary, const std::string& command_line);

/// How many of the runs are seen within what time, a curve per detector; none: no run has a fault.
[[nodiscard]] std::optional<report::Chart> delay_chart_of(const Results& results);

}  // namespace offnominal::desk::campaign
