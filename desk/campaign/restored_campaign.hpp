#pragma once

#include <filesystem>
#include <string>

#include "campaign/campaign.hpp"

namespace offnominal::desk::campaign {

/// The campaign that results are of, from what they say of it themselves (Campaign::identity): keys
/// and robots are all in it. Its files are written into `folder`. Throws InputError, in the name of
/// `results`, where another version wrote it.
[[nodiscard]] Campaign restored_campaign(const std::string& identity,
                                         const std::filesystem::path& folder,
                                         const std::string& results);

}  // namespace offnominal::desk::campaign
