#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "campaign/campaign.hpp"
#include "campaign/result_file.hpp"
#include "campaign/simulate.hpp"
#include "studio/session_files.hpp"
#include "studio/upload_folder.hpp"

namespace offnominal::desk::studio {

/// Which runs of a campaign are looked at; what is not said is all of it.
struct RunFilter {
  std::optional<std::string> detector = {};
  std::optional<std::string> kind = {};  // of the fault; runs without one stay in the figures
  std::optional<int> joint = {};         // of the fault, from 1
  std::string outcome = {};              // of a run, of any of the detectors: "missed", "early"
};

inline constexpr std::size_t kMostRunsAtOnce = 200;

/// The results of a campaign, and its runs as recordings. Every function may be called by any
/// thread, answers as docs/studio.md has it, and throws Refused or InputError where it cannot be
/// done.
class CampaignView {
 public:
  /// `file`: of the campaign, which the commands that repeat a session name; none: the results say
  /// themselves what was run. Throws InputError where the results cannot be read, or are those of
  /// another campaign.
  CampaignView(const std::string& results, const std::optional<std::string>& file);

  /// What it holds: {name, file, runs, missing, detectors, kinds, joints}.
  [[nodiscard]] nlohmann::ordered_json state() const;
  /// Tables and charts of the rows that the filter leaves, as report pages hold their sections. Of
  /// a filter's fault the fault-free runs stay: false alarms are counted in them.
  [[nodiscard]] nlohmann::json figures(const RunFilter& filter) const;
  /// {count, from, runs}: kMostRunsAtOnce runs at most, the number `from` of those that the filter
  /// leaves first.
  [[nodiscard]] nlohmann::ordered_json runs(const RunFilter& filter, std::size_t from) const;
  /// One run once more, as a recording of the model that the detectors have, as `offnominal
  /// campaign record` writes it. It lies in a folder that goes with this object.
  [[nodiscard]] SessionFiles record(std::int64_t run);

  [[nodiscard]] const UploadFolder& folder() const { return folder_; }

 private:
  [[nodiscard]] campaign::Results left_by(const RunFilter& filter) const;
  [[nodiscard]] std::vector<report::EventMark> marks_of(std::int64_t run) const;
  void restore();

  std::string results_file_;
  std::optional<std::string> campaign_file_;
  campaign::Results results_;
  std::optional<campaign::Campaign> campaign_;
  std::mutex recording_;  // one run at a time
  std::unique_ptr<campaign::Simulator> simulator_;
  UploadFolder folder_;
};

}  // namespace offnominal::desk::studio
