#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "campaign/campaign.hpp"
#include "campaign/detector.hpp"
#include "campaign/result_file.hpp"
#include "campaign/score.hpp"
#include "campaign/simulate.hpp"

namespace offnominal::desk::campaign {

struct RunRequest {
  std::filesystem::path output;  // results; there already: of this campaign, gone on with
  Shard shard;
  int threads = 1;
};

/// What is being done, and how many of how many are.
using OnProgress = std::function<void(const std::string& what, std::int64_t done, std::int64_t of)>;

/// A campaign with its detectors calibrated, ready for any of its runs.
class CalibratedCampaign {
 public:
  /// Runs without faults and calibrates on them, on `threads` threads. The campaign has to outlive
  /// it. Throws InputError as Simulator and calibrated() do.
  CalibratedCampaign(const Campaign& campaign, int threads, const OnProgress& on_progress);

  /// What its results' file says of it.
  [[nodiscard]] CampaignRow row() const;
  /// The rows of one run, in the detectors' order; 0 <= number < run_count(). May be called by
  /// several threads at once.
  [[nodiscard]] std::vector<Result> run(std::int64_t number) const;

 private:
  const Campaign& campaign_;
  Simulator simulator_;
  std::vector<std::unique_ptr<Detector>> detectors_;
};

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
