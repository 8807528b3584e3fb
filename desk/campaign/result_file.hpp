#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "campaign/campaign.hpp"
#include "campaign/score.hpp"
#include "common/file.hpp"
#include "common/sqlite.hpp"

// Results in one SQLite file: table `campaign` (what was run), `detector` (with its thresholds),
// `result` (a row for every run and detector, columns as of Result). docs/campaigns.md has them.

namespace offnominal::desk::campaign {

/// A detector as it was calibrated.
struct DetectorRow {
  std::string name;
  std::string thresholds;
  std::string notes;  // sentences, a line each

  friend bool operator==(const DetectorRow&, const DetectorRow&) = default;
};

/// What a file of results says of its campaign.
struct CampaignRow {
  std::string name;
  std::string identity;  // Campaign::identity
  std::int64_t runs = 0;
  std::vector<DetectorRow> detectors;  // in the campaign's order

  friend bool operator==(const CampaignRow&, const CampaignRow&) = default;
};

/// Everything that a file holds.
struct Results {
  CampaignRow campaign;
  std::vector<Result> rows;           // by run, then in the detectors' order
  std::vector<std::int64_t> missing;  // runs of the campaign that it has not
};

class ResultFile {
 public:
  /// Opens results to go on with, or begins a new file. Throws InputError, the file left as it is,
  /// where it is no such file, is damaged, or holds the results of another campaign, or of the same
  /// with other thresholds, as a machine computes that rounds otherwise.
  [[nodiscard]] static ResultFile open(const std::filesystem::path& path,
                                       const CampaignRow& campaign);

  /// Throws as open() does, before there are thresholds to compare.
  static void check(const std::filesystem::path& path, const Campaign& campaign);

  /// Of these runs, in their order, those that it does not have.
  [[nodiscard]] std::vector<std::int64_t> missing_of(std::vector<std::int64_t> runs);
  /// All rows of one run, or none of them.
  void add(const std::vector<Result>& rows);

 private:
  explicit ResultFile(Database database) : database_(std::move(database)) {}
  Database database_;
};

/// Throws InputError for a file that holds no results, or damaged ones.
[[nodiscard]] Results read_results(const std::filesystem::path& path);

/// All results of several files of one campaign. Throws InputError where they are of different
/// ones, were calibrated otherwise, or disagree about a run that several of them hold.
[[nodiscard]] Results merged(const std::vector<std::filesystem::path>& paths);

/// Whole or not at all.
void write_results(const std::filesystem::path& path, const Results& results, Existing existing);

/// "3, 5 to 9": at most so many stretches are listed.
[[nodiscard]] std::string run_list(const std::vector<std::int64_t>& numbers);

}  // namespace offnominal::desk::campaign
