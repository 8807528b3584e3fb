#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "explain/explain.hpp"
#include "report/page.hpp"

namespace offnominal::desk {

// What names an explanation in its outputs.
struct ExplainNames {
  std::vector<std::string> logs;
  std::vector<std::string> holdout;
  std::string robot_file;
  std::string command_line;
  std::string channels = {};                    // file of --channels, empty: none
  std::vector<RecordingPayload> payloads = {};  // of --payload
  std::vector<KeepFault> keep = {};             // of --keep
  std::optional<double> link_share = {};        // of --link-share
  bool keep_effects = false;                    // --keep-effects
  std::vector<std::string> after = {};          // of --after: the last of `logs`
};

// How a page shows a verdict.
report::Level level_of(Verdict verdict);

// docs/explain.md lists the keys. Joints count from 1.
nlohmann::ordered_json to_json(const Explanation& explanation, const ExplainNames& names);

// For a terminal: the verdict, then the evidence.
std::string findings_text(const Explanation& explanation, const ExplainNames& names);

// The same, and how to write what was found.
std::string text_of(const Explanation& explanation, const ExplainNames& names);

// The same with pictures; every number on it is in to_json().
report::Page page_of(const Explanation& explanation, const ExplainNames& names);

}  // namespace offnominal::desk
