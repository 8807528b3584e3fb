#pragma once

#include <filesystem>
#include <string>

#include "campaign/campaign.hpp"

namespace offnominal::desk::campaign {

/// A campaign file (docs/campaigns.md lists every key), with the robot files that it names, their
/// paths relative to its own folder, and the errors of the model drawn. Throws InputError with
/// file, line, key, what was found, what is allowed and how to mend it at the first thing that is
/// wrong; unknown keys are wrong, and so is a plant whose joints are not the robot's.
[[nodiscard]] Campaign read_campaign(const std::filesystem::path& path);

/// The kinds of faults with what their sizes are, a line each, for help.
[[nodiscard]] std::string fault_kinds_text();

}  // namespace offnominal::desk::campaign
