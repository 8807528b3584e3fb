#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sil/sil.hpp"

namespace offnominal::tools::sil {

/// A scenario as a TOML file says it (docs/sil.md has every key). Throws InputError with file, line
/// and key; of what the numbers mean together check_scenario() judges.
[[nodiscard]] Scenario read_scenario(const std::filesystem::path& path);

/// The scenario as a file that read_scenario() reads as the same.
[[nodiscard]] std::string scenario_text(const Scenario& scenario);

/// Every kind of fault with its unit and what it does, a line each: for a help text.
[[nodiscard]] std::string fault_kinds_text();

}  // namespace offnominal::tools::sil
