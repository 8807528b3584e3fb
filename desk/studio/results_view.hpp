#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "common/error.hpp"
#include "studio/session_files.hpp"

namespace offnominal::desk::studio {

/// What is looked at of results: a value of some of the filters that state() names.
using ResultsFilter = std::map<std::string, std::string>;

inline constexpr std::size_t kMostRunsAtOnce = 200;

/// Results of many runs: those of a campaign, or the cases of a benchmark. Every function may be
/// called by any thread, answers as docs/studio.md has it, and throws Refused or InputError where
/// it cannot be done.
class ResultsView {
 public:
  virtual ~ResultsView() = default;

  /// What it holds, how it is called, and its filters.
  [[nodiscard]] virtual nlohmann::ordered_json state() const = 0;
  /// Tables and charts of what the filter leaves, as report pages hold their sections.
  [[nodiscard]] virtual nlohmann::json figures(const ResultsFilter& filter) const = 0;
  /// kMostRunsAtOnce runs at most, the number `from` of those that the filter leaves first.
  [[nodiscard]] virtual nlohmann::ordered_json runs(const ResultsFilter& filter,
                                                    std::size_t from) const = 0;
  /// One run as recordings, with its robot file.
  [[nodiscard]] virtual SessionFiles record(std::int64_t run) = 0;
  /// What a monitor saw of a run (a detector of state()'s `monitors`): {run, detector, words,
  /// level, sections}. Not of a benchmark, whose cases nobody watched.
  [[nodiscard]] virtual nlohmann::json watched(std::int64_t run, const std::string& detector);
  /// What is wrong with these, with files by the names that the user knows.
  [[nodiscard]] virtual InputError shown(const InputError& error) const { return error; }
};

/// A filter as the page has it: {key, label, of, options}; `of`: "all" or "list", whether the
/// figures follow it too. Of the options the first is all that there is, its value empty.
struct FilterOption {
  std::string value;
  std::string words;
};
[[nodiscard]] nlohmann::ordered_json filter_json(const std::string& key, const std::string& label,
                                                 bool of_list_alone,
                                                 const std::vector<FilterOption>& options);

/// One value of a run in the list; `level`: "", "warn" or "bad".
[[nodiscard]] nlohmann::ordered_json cell_json(const std::string& words,
                                               const std::string& level = "");

/// Throws Refused: what a filter asks for is not there.
[[noreturn]] void refuse_filter(const std::string& words);
/// Throws Refused where a filter is none of these (filter_json), or its value none of its options.
void check_filters(const ResultsFilter& filter, const nlohmann::ordered_json& known);
/// The filter's value; empty: all.
[[nodiscard]] std::string value_of(const ResultsFilter& filter, const std::string& key);

}  // namespace offnominal::desk::studio
