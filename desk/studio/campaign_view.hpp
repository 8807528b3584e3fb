#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>

#include "campaign/campaign.hpp"
#include "campaign/result_file.hpp"
#include "campaign/simulate.hpp"
#include "replay/replay.hpp"
#include "report/page.hpp"
#include "studio/results_view.hpp"
#include "studio/upload_folder.hpp"

namespace offnominal::desk::studio {

/// The results of a campaign, and its runs as recordings. Filters: `detector`, `kind` and `joint`
/// of the fault, and of the list `outcome`, of any of the detectors: "missed", "early".
class CampaignView final : public ResultsView {
 public:
  /// `file`: of the campaign, which the commands that repeat a session name; none: the results say
  /// themselves what was run. Throws InputError where the results cannot be read, or are those of
  /// another campaign.
  CampaignView(const std::string& results, const std::optional<std::string>& file);

  [[nodiscard]] nlohmann::ordered_json state() const override;
  /// Of a filter's fault the fault-free runs stay: false alarms are counted in them.
  [[nodiscard]] nlohmann::json figures(const ResultsFilter& filter) const override;
  [[nodiscard]] nlohmann::ordered_json runs(const ResultsFilter& filter,
                                            std::size_t from) const override;
  /// Run once more, with the model that the detectors have, as `offnominal campaign record` writes
  /// it. It lies in a folder that goes with this object.
  [[nodiscard]] SessionFiles record(std::int64_t run) override;
  /// The monitor with the bound that the results hold, over the run as record() has it.
  [[nodiscard]] nlohmann::json watched(std::int64_t run, const std::string& detector) override;
  [[nodiscard]] InputError shown(const InputError& error) const override {
    return folder_.shown(error);
  }

 private:
  [[nodiscard]] campaign::Results left_by(const ResultsFilter& filter) const;
  [[nodiscard]] std::vector<report::EventMark> marks_of(std::int64_t run) const;
  void restore();
  void add_what_results_say(std::int64_t run, const std::string& detector, const Replay& shown,
                            report::Page& page) const;
  // Whoever calls holds `recording_`.
  const Log& log_of(std::int64_t run);

  std::string results_file_;
  std::optional<std::string> campaign_file_;
  campaign::Results results_;
  std::optional<campaign::Campaign> campaign_;
  std::mutex recording_;  // one run at a time
  std::unique_ptr<campaign::Simulator> simulator_;
  std::optional<std::pair<std::int64_t, Log>> newest_;  // the run that was asked for last
  UploadFolder folder_;
};

}  // namespace offnominal::desk::studio
