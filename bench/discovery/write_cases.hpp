#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "case_groups.hpp"

namespace offnominal::bench {

// Writes every case as its owner would have it, into a new folder GROUP-NUMBER of `folder` each:
// robot.toml, recording.csv, holdout.csv, and truth.json with what is hidden. Returns the folders.
// Throws desk::InputError where one of them is there already or cannot be written.
std::vector<std::filesystem::path> write_cases(const std::vector<CaseGroup>& groups,
                                               const std::filesystem::path& folder);

}  // namespace offnominal::bench
