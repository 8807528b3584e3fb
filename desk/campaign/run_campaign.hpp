#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "campaign/campaign.hpp"

namespace offnominal::desk::campaign {

struct RunRequest {
  std::filesystem::path output;  // results; there already: of this campaign, gone on with
  Shard shard;
  int threads = 1;
};

/// What is being done, and how many of how many are.
using OnProgress = std::function<void(const std::string& what, std::int64_t done, std::int64_t of)>;

struct RunOutcome {
  std::int64_t runs = 0;     // of the shard
  std::int64_t skipped = 0;  // that were in the file already
};

/// Calibrates every detector, then runs what the file does not have, and adds each run as it is
/// done, on `threads` threads. The rows are the same for any number of threads and any shard.
/// `on_progress` is never called by two threads at once. Throws InputError as read_campaign(),
/// calibrated() and ResultFile do; what was added stays.
RunOutcome run_campaign(const Campaign& campaign, const RunRequest& request,
                        const OnProgress& on_progress);

}  // namespace offnominal::desk::campaign
