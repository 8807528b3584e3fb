#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "campaign/summary.hpp"
#include "report/page.hpp"

namespace offnominal::desk::campaign {

[[nodiscard]] std::string text_of(const Summary& summary);
[[nodiscard]] nlohmann::ordered_json to_json(const Summary& summary);
/// Tables, ROC curves, and the share of runs in which a fault is seen over its size.
[[nodiscard]] report::Page page_of(const Summary& summary, const std::string& command_line);

}  // namespace offnominal::desk::campaign
