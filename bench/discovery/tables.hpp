#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "goals.hpp"
#include "summary.hpp"

namespace offnominal::bench {

// Markdown tables.
std::string table_of(const std::vector<Summary>& lines);
std::string table_of(const std::vector<EffectSummary>& effects);
// Every case that was not answered rightly: how to run it again and what was said.
std::string failures_of(const CaseGroup& group, const std::vector<Outcome>& outcomes);

nlohmann::ordered_json json_of(const Summary& line);
nlohmann::ordered_json json_of(const CaseGroup& group, const Outcome& outcome);

}  // namespace offnominal::bench
