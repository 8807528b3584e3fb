#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sil/sil.hpp"

namespace offnominal::desk::sil {

/// A scenario as a TOML file says it (docs/sil.md has every key), for a plant, of the paper's arm
/// where that is none; `duration_s`: of a run that somebody wants to be of another length than the
/// file says. Throws InputError with file, line and key; of what else the numbers mean together
/// check_scenario() judges.
[[nodiscard]] Scenario read_scenario(const std::filesystem::path& path,
                                     const std::optional<RobotDescription>& plant = std::nullopt,
                                     std::optional<double> duration_s = std::nullopt);

/// The scenario, but for its plant, as a file that read_scenario() reads as the same.
[[nodiscard]] std::string scenario_text(const Scenario& scenario);

/// Every kind of fault with its unit and what it does, a line each: for a help text.
[[nodiscard]] std::string fault_kinds_text();

}  // namespace offnominal::desk::sil
