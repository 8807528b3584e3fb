#include "studio/campaign_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "campaign/campaign_file.hpp"
#include "campaign/monitor_detector.hpp"
#include "campaign/restored_campaign.hpp"
#include "campaign/summary.hpp"
#include "campaign/summary_report.hpp"
#include "common/error.hpp"
#include "common/input_name.hpp"
#include "common/plain_words.hpp"
#include "common/shell_word.hpp"
#include "log/csv_text.hpp"
#include "replay/replay.hpp"
#include "report/page.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk::studio {
namespace {

using campaign::Result;
using nlohmann::ordered_json;

constexpr const char* kFaultFree = "none";

bool is_of_fault(const Result& row, const ResultsFilter& filter) {
  const std::string kind = value_of(filter, "kind");
  const std::string joint = value_of(filter, "joint");
  if (!kind.empty() && row.kind != kind) return false;
  return joint.empty() || (row.joint && std::to_string(*row.joint) == joint);
}

// What became of a run under one detector.
const char* outcome_of(const Result& row) {
  if (row.kind == kFaultFree) return row.alarms > 0 ? "false alarm" : "quiet";
  if (row.early) return "early";
  return row.detected ? "seen" : "missed";
}

std::string words_of(const Result& row) {
  const std::string outcome = outcome_of(row);
  if (outcome == "early") return "an alarm before the fault";
  if (outcome == "false alarm") {
    return fmt::format("{} alarm{} without a fault", row.alarms, row.alarms == 1 ? "" : "s");
  }
  if (outcome == "missed") return "not seen";
  if (outcome == "quiet") return "no alarm";
  std::string words = row.delay_s ? fmt::format("seen after {:.3f} s", *row.delay_s) : "seen";
  if (row.named) words += fmt::format(", said to be {}", offnominal::name_of(row.named->kind));
  return words;
}

// All that one run says, in the campaign's order of the detectors.
std::map<std::int64_t, std::vector<const Result*>> by_run(const std::vector<Result>& rows) {
  std::map<std::int64_t, std::vector<const Result*>> runs;
  for (const Result& row : rows) runs[row.run].push_back(&row);
  return runs;
}

const char* level_of(const std::string& outcome) {
  if (outcome == "missed") return "warn";
  return outcome == "early" || outcome == "false alarm" ? "bad" : "";
}

ordered_json run_json(std::int64_t number, const std::vector<const Result*>& rows) {
  const Result& first = *rows.front();
  const std::string fault =
      first.kind == kFaultFree ? "no fault" : campaign::place_words(first.kind, first.joint);
  const std::string size = campaign::size_words(first.kind, first.size);
  ordered_json cells = {cell_json(fault), cell_json(size)};
  for (const Result* row : rows) {
    cells.push_back(cell_json(words_of(*row), level_of(outcome_of(*row))));
  }
  return {{"run", number},
          {"label", size.empty() ? fault : fault + ", " + size},
          {"cells", std::move(cells)}};
}

// "momentum observer, filter of 10 1/s" of "momentum_observer 10": the name that a detector has by
// itself is its kind and its filter. One that the campaign's file gives it stays as it is.
std::string detector_words(const std::string& name) {
  const std::size_t space = name.find(' ');
  if (space == std::string::npos) return name;
  const std::string kind = name.substr(0, space);
  const std::string filter = name.substr(space + 1);
  const auto kinds = {"torque", "acceleration", "momentum_observer", "kdl"};
  const bool is_kind =
      std::any_of(kinds.begin(), kinds.end(), [&](const char* one) { return kind == one; });
  const bool is_number = filter.find_first_not_of("0123456789.e-+") == std::string::npos;
  return is_kind && is_number ? fmt::format("{}, filter of {} 1/s", in_words(kind), filter) : name;
}

// "run_12", and after it what makes both files of a run's names free here.
std::string free_stem(const std::string& stem) {
  for (int number = 1;; ++number) {
    std::string name = number == 1 ? stem : fmt::format("{}_{}", stem, number);
    std::error_code ignored;
    const bool taken = std::filesystem::exists(name + ".csv", ignored) ||
                       std::filesystem::exists(name + "_model.toml", ignored);
    if (!taken) return name;
  }
}

}  // namespace

CampaignView::CampaignView(const std::string& results, const std::optional<std::string>& file)
    : results_file_(results), campaign_file_(file), results_(campaign::read_results(results)) {
  if (!file) return;
  campaign_ = campaign::read_campaign(*file);
  if (campaign_->identity == results_.campaign.identity) return;
  throw InputError({*file, "", "another campaign than that of " + results,
                    "the campaign file as it was run, with its robot files, by this version",
                    "leave it out: tables and charts need none; or run the campaign anew"});
}

ordered_json CampaignView::state() const {
  std::vector<FilterOption> detectors{{"", "all detectors"}};
  for (const campaign::DetectorRow& one : results_.campaign.detectors) {
    detectors.push_back({one.name, detector_words(one.name)});
  }
  ordered_json monitors = ordered_json::array();
  for (const campaign::DetectorRow& one : results_.campaign.detectors) {
    if (campaign::are_of_monitor(one.thresholds)) monitors.push_back(one.name);
  }
  std::vector<FilterOption> kinds{{"", "all faults"}};
  std::set<int> of_joints;
  for (const Result& row : results_.rows) {
    if (row.kind == kFaultFree) continue;
    const bool is_new = std::none_of(
        kinds.begin(), kinds.end(), [&](const FilterOption& one) { return one.value == row.kind; });
    if (is_new) kinds.push_back({row.kind, in_words(row.kind)});
    if (row.joint) of_joints.insert(*row.joint);
  }
  std::vector<FilterOption> joints{{"", "every joint or link"}};
  for (const int joint : of_joints)
    joints.push_back({std::to_string(joint), std::to_string(joint)});
  const std::int64_t all = results_.campaign.runs;
  const auto missing = static_cast<std::int64_t>(results_.missing.size());
  const std::string there =
      missing == 0 ? fmt::format("{} runs", all) : fmt::format("{} of {} runs", all - missing, all);
  return {
      {"item", "run"},
      {"name", results_.campaign.name},
      {"title", "Campaign: " + results_.campaign.name},
      {"subtitle", input_name(results_file_) + " \u00b7 " + there},
      {"heading", "What was seen"},
      {"list_heading", "Run by run"},
      {"list_words",
       "A click on a number runs it once more and opens it below as a recording, with the model "
       "that the detectors have."},
      {"count", all},
      {"monitors", std::move(monitors)},
      {"filters",
       {filter_json("kind", "Fault", false, kinds), filter_json("joint", "Joint", false, joints),
        filter_json("detector", "Detector", false, detectors),
        filter_json("outcome", "Show", true,
                    {{"", "all runs"},
                     {"missed", "those that a detector missed"},
                     {"early", "those with a false or early alarm"}})}}};
}

campaign::Results CampaignView::left_by(const ResultsFilter& filter) const {
  check_filters(filter, state().at("filters"));
  campaign::Results left = results_;
  const std::string detector = value_of(filter, "detector");
  if (!detector.empty()) {
    std::erase_if(left.campaign.detectors,
                  [&](const campaign::DetectorRow& one) { return one.name != detector; });
  }
  std::erase_if(left.rows, [&](const Result& row) {
    if (!detector.empty() && row.detector != detector) return true;
    return row.kind != kFaultFree && !is_of_fault(row, filter);
  });
  return left;
}

nlohmann::json CampaignView::figures(const ResultsFilter& filter) const {
  const campaign::Results left = left_by(filter);
  report::Page page = page_of(campaign::summary_of(left), "");
  if (auto delays = campaign::delay_chart_of(left)) {
    std::vector<report::Block>& blocks = page.sections.front().blocks;
    // Beside the other curve of detectors.
    const bool has_roc = !blocks.empty() && std::holds_alternative<report::Chart>(blocks.front());
    if (has_roc) std::get<report::Chart>(blocks.front()).width = report::Width::kHalf;
    delays->width = has_roc ? report::Width::kHalf : report::Width::kFull;
    blocks.insert(blocks.begin() + (has_roc ? 1 : 0), std::move(*delays));
  }
  return {{"sections", to_json(page).at("sections")}};
}

ordered_json CampaignView::runs(const ResultsFilter& filter, std::size_t from) const {
  const std::string wanted = value_of(filter, "outcome");
  const campaign::Results left = left_by(filter);
  const bool of_a_fault = !value_of(filter, "kind").empty() || !value_of(filter, "joint").empty();
  ordered_json columns = {"Run", "Fault", "Size"};
  for (const campaign::DetectorRow& one : left.campaign.detectors) columns.push_back(one.name);
  ordered_json runs = ordered_json::array();
  std::size_t count = 0;
  for (const auto& [number, rows] : by_run(left.rows)) {
    if (of_a_fault && rows.front()->kind == kFaultFree) continue;
    const bool has_outcome = std::any_of(rows.begin(), rows.end(), [&](const Result* row) {
      const std::string outcome = outcome_of(*row);
      return wanted == outcome || (wanted == "early" && outcome == "false alarm");
    });
    if (!wanted.empty() && !has_outcome) continue;
    if (count >= from && runs.size() < kMostRunsAtOnce) runs.push_back(run_json(number, rows));
    ++count;
  }
  return {{"count", count},
          {"from", from},
          {"most", kMostRunsAtOnce},
          {"columns", std::move(columns)},
          {"runs", std::move(runs)}};
}

std::vector<report::EventMark> CampaignView::marks_of(std::int64_t run) const {
  std::vector<report::EventMark> marks;
  for (const Result& row : results_.rows) {
    if (row.run != run || !row.fault_s) continue;
    if (marks.empty()) marks.push_back({*row.fault_s, row.kind, report::Level::kBad});
    if (row.detected && row.delay_s) {
      marks.push_back({*row.fault_s + *row.delay_s, row.detector, report::Level::kGood});
    }
  }
  return marks;
}

void CampaignView::restore() {
  campaign_ =
      campaign::restored_campaign(results_.campaign.identity, folder_.path(), results_file_);
}

const Log& CampaignView::log_of(std::int64_t run) {
  if (!campaign_) restore();
  if (run < 0 || run >= campaign_->run_count()) refuse_filter("There is no such run.");
  if (!simulator_) simulator_ = std::make_unique<campaign::Simulator>(*campaign_);
  if (!newest_ || newest_->first != run) {
    newest_.emplace(run, simulator_->run(campaign::run_of(*campaign_, run)).log);
    newest_->second.file = fmt::format("run {}", run);
  }
  return newest_->second;
}

// Where the monitor's own words would mislead whoever knows of the fault.
void CampaignView::add_what_results_say(std::int64_t run, const std::string& detector,
                                        const Replay& shown, report::Page& page) const {
  const auto row = std::find_if(results_.rows.begin(), results_.rows.end(), [&](const Result& one) {
    return one.run == run && one.detector == detector;
  });
  if (row == results_.rows.end() || !row->fault_s) return;
  if (!row->detected && !row->early) {
    page.verdict.words = "The fault was missed. " + page.verdict.words;
    page.verdict.level = report::Level::kWarn;
  } else if (!row->early && shown.detection_time_s && *shown.detection_time_s < *row->fault_s) {
    page.verdict.words +=
        " An alarm so little before the fault is of it: the recording's velocities see some "
        "milliseconds ahead. The results count it as at once.";
  }
}

nlohmann::json CampaignView::watched(std::int64_t run, const std::string& detector) {
  const std::lock_guard guard(recording_);
  const Log& log = log_of(run);
  const auto& detectors = results_.campaign.detectors;
  const auto found = std::find_if(detectors.begin(), detectors.end(),
                                  [&](const auto& one) { return one.name == detector; });
  const auto robot = found == detectors.end()
                         ? std::nullopt
                         : campaign::judging_robot(*campaign_, detector, found->thresholds);
  if (!robot) refuse_filter("There is no such monitor.");
  const Replay shown = replay(*robot, log);
  report::Page page = page_of(shown, "");
  add_what_results_say(run, detector, shown, page);
  // Who alarmed when is the other detectors' as well: of the marks the fault's alone.
  std::vector<report::EventMark> marks = marks_of(run);
  std::erase_if(marks, [](const auto& mark) { return mark.level != report::Level::kBad; });
  for (report::Section& section : page.sections) {
    for (report::Block& block : section.blocks) {
      auto* const chart = std::get_if<report::Chart>(&block);
      if (chart != nullptr) chart->events.insert(chart->events.end(), marks.begin(), marks.end());
    }
  }
  const nlohmann::json json = to_json(page);
  return {{"run", run},
          {"detector", detector},
          {"words", json.at("verdict").at("words")},
          {"level", json.at("verdict").at("level")},
          {"sections", json.at("sections")}};
}

SessionFiles CampaignView::record(std::int64_t run) {
  const std::lock_guard guard(recording_);
  const Log& log = log_of(run);
  const std::string stem = free_stem(fmt::format("run_{}", run));
  const std::string recording = stem + ".csv";
  const std::string model = stem + "_model.toml";
  SessionFiles files;
  files.logs.push_back({folder_.put(recording, csv_text(log)).string(), recording});
  files.robot = {folder_.put(model, robot_text(campaign_->model)).string(), model};
  files.commands_before.push_back(
      fmt::format("offnominal campaign record {} --run {} -o {} --model {}",
                  campaign_file_ ? shell_word(*campaign_file_) : "CAMPAIGN.toml", run,
                  shell_word(recording), shell_word(model)));
  if (!campaign_file_) files.commands_note = "CAMPAIGN.toml stands for the file of the campaign.";
  files.marks = marks_of(run);
  return files;
}

}  // namespace offnominal::desk::studio
