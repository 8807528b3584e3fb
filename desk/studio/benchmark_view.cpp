#include "studio/benchmark_view.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "campaign/summary.hpp"
#include "common/error.hpp"
#include "common/input_name.hpp"
#include "common/plain_words.hpp"
#include "common/refused.hpp"
#include "report/page.hpp"

namespace offnominal::desk::studio {

using benchmark::Asked;
using benchmark::Case;
using benchmark::Outcome;
using nlohmann::ordered_json;

namespace {

constexpr std::array kOutcomeFilters{
    std::pair{"missed", "those with something missed"},
    std::pair{"in_class", "those with something in a class of several"},
    std::pair{"wrong", "those with something named that is not there"},
    std::pair{"failed", "those without an answer"},
};

// Those of a case that the filter asks for.
bool is_of(const Asked& one, const ResultsFilter& filter) {
  const std::string effect = value_of(filter, "effect");
  const std::string joint = value_of(filter, "joint");
  if (!effect.empty() && one.effect != effect) return false;
  return joint.empty() || std::to_string(one.joint) == joint;
}

bool has_outcome(const Case& one, const ResultsFilter& filter, const std::string& wanted) {
  if (wanted.empty()) return true;
  if (wanted == "wrong") return !one.wrong.empty();
  if (wanted == "failed") return !one.failed.empty();
  return std::any_of(one.asked.begin(), one.asked.end(), [&](const Asked& asked) {
    return is_of(asked, filter) && wanted == benchmark::name_of(asked.outcome);
  });
}

// What came of a case, and how bad that is.
ordered_json outcome_cell(const Case& one) {
  if (!one.failed.empty()) return cell_json("no answer: " + one.failed, "bad");
  if (!one.wrong.empty()) {
    return cell_json(fmt::format("not there: {}", fmt::join(one.wrong, ", ")), "bad");
  }
  std::vector<std::string> missed;
  for (const Asked& asked : one.asked) {
    if (asked.outcome == Outcome::kMissed) {
      missed.push_back(fmt::format("{}, joint {}", in_words(asked.effect), asked.joint));
    }
  }
  if (missed.empty()) return cell_json(one.asked.empty() ? "nothing named" : "right");
  return cell_json(fmt::format("missed: {}", fmt::join(missed, ", ")), "warn");
}

ordered_json run_json(const Case& one) {
  return {{"run", one.number},
          {"label", one.group + ", hidden: " + one.hidden},
          {"cells",
           {cell_json(one.group), cell_json(one.hidden), cell_json(one.said), outcome_cell(one),
            cell_json(fmt::format("{:.1f} s", one.time_s))}}};
}

struct Counts {
  std::array<std::int64_t, benchmark::kOutcomes> of{};
  std::map<std::string, int> instead;

  [[nodiscard]] std::int64_t all() const { return of[0] + of[1] + of[2]; }
  [[nodiscard]] std::int64_t answered() const { return of[0] + of[1]; }
  void take(const Asked& one) {
    ++of[static_cast<std::size_t>(one.outcome)];
    if (one.outcome == Outcome::kMissed && !one.instead.empty()) ++instead[one.instead];
  }
};

std::string instead_words(const std::map<std::string, int>& instead) {
  std::vector<std::pair<int, std::string>> by_count;
  for (const auto& [name, count] : instead) by_count.emplace_back(-count, name);
  std::sort(by_count.begin(), by_count.end());
  constexpr std::size_t kMost = 3;
  std::vector<std::string> words;
  for (std::size_t i = 0; i < std::min(kMost, by_count.size()); ++i) {
    words.push_back(fmt::format("{} ({})", by_count[i].second, -by_count[i].first));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

report::Table table_of(const std::string& caption, const std::string& what,
                       const std::vector<std::pair<std::string, Counts>>& rows) {
  report::Table table;
  table.caption = caption;
  table.columns = {{what, ""},
                   {"hidden", "1", "d"},
                   {"named alone", "1", "d"},
                   {"in a class", "1", "d"},
                   {"missed", "1", "d"},
                   {"answered", "%", ".1f"},
                   {"95 %, from", "%", ".1f"},
                   {"to", "%", ".1f"},
                   {"said instead", ""}};
  for (const auto& [name, counts] : rows) {
    if (counts.all() == 0) continue;
    const campaign::Estimate answered = campaign::share_of(counts.answered(), counts.all());
    const auto number = [](std::int64_t value) { return static_cast<double>(value); };
    table.rows.push_back({name, number(counts.all()), number(counts.of[0]), number(counts.of[1]),
                          number(counts.of[2]), 100 * answered.value, 100 * answered.low,
                          100 * answered.high, instead_words(counts.instead)});
  }
  table.note = "Answered: named, or in a class of effects that the recordings cannot tell apart.";
  return table;
}

// By how much of the joint's torque it is: equal shares of what has one.
std::optional<report::Chart> found_over_size(const std::vector<const Asked*>& asked) {
  std::vector<const Asked*> sized;
  for (const Asked* one : asked) {
    if (one->share && *one->share > 0) sized.push_back(one);
  }
  constexpr std::size_t kFewest = 20;
  if (sized.size() < kFewest) return std::nullopt;
  std::sort(sized.begin(), sized.end(),
            [](const Asked* a, const Asked* b) { return *a->share < *b->share; });
  const std::size_t bins = std::min<std::size_t>(8, sized.size() / 10);
  report::Series bars;
  bars.name = "answered";
  bars.kind = report::SeriesKind::kBars;
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const std::size_t begin = bin * sized.size() / bins;
    const std::size_t end = (bin + 1) * sized.size() / bins;
    const auto answered =
        std::count_if(sized.begin() + static_cast<std::ptrdiff_t>(begin),
                      sized.begin() + static_cast<std::ptrdiff_t>(end),
                      [](const Asked* one) { return one->outcome != Outcome::kMissed; });
    bars.x.push_back(100 * *sized[begin]->share);
    bars.y.push_back(100.0 * static_cast<double>(answered) / static_cast<double>(end - begin));
  }
  bars.x.push_back(100 * *sized.back()->share);
  for (std::size_t i = 1; i < bars.x.size(); ++i) {
    if (!(bars.x[i] > bars.x[i - 1])) return std::nullopt;
  }
  report::Chart chart;
  chart.title = "Answered, over the size";
  chart.x = {"share of the joint's torque", "%", true, {}, {}};
  chart.y = {{"named or in a class", "%", false, 0, 100}};
  chart.series = {std::move(bars)};
  chart.width = report::Width::kHalf;
  chart.note = "As many of what was hidden in every bar; the size is a root mean square.";
  return chart;
}

std::optional<report::Chart> times_chart(const std::vector<const Case*>& cases) {
  std::vector<double> times;
  for (const Case* one : cases) {
    if (one->failed.empty()) times.push_back(one->time_s);
  }
  if (times.size() < 2) return std::nullopt;
  std::sort(times.begin(), times.end());
  report::Series steps;
  steps.name = "cases";
  steps.kind = report::SeriesKind::kSteps;
  steps.x.push_back(0);
  steps.y.push_back(0);
  for (std::size_t i = 0; i < times.size(); ++i) {
    steps.x.push_back(times[i]);
    steps.y.push_back(100.0 * static_cast<double>(i + 1) / static_cast<double>(times.size()));
  }
  report::Chart chart;
  chart.title = "Time of explain";
  chart.x = {"time", "s", false, 0, {}};
  chart.y = {{"cases answered by then", "%", false, 0, 100}};
  chart.series = {std::move(steps)};
  chart.width = report::Width::kHalf;
  return chart;
}

std::string words_of_wrong(const std::vector<const Case*>& cases) {
  const auto count = [&](const auto& is_one) {
    return std::count_if(cases.begin(), cases.end(), [&](const Case* one) { return is_one(*one); });
  };
  return fmt::format(
      "Cases with something named that is not there: {} of {}; without an answer: {}.",
      count([](const Case& one) { return !one.wrong.empty(); }), cases.size(),
      count([](const Case& one) { return !one.failed.empty(); }));
}

}  // namespace

BenchmarkView::BenchmarkView(const std::string& results)
    : results_file_(results), results_(benchmark::read_benchmark(results)) {}

ordered_json BenchmarkView::state() const {
  std::set<std::string> groups;
  std::set<std::string> effects;
  std::set<int> joints;
  for (const Case& one : results_.cases) {
    groups.insert(one.group);
    for (const Asked& asked : one.asked) {
      effects.insert(asked.effect);
      joints.insert(asked.joint);
    }
  }
  std::vector<FilterOption> of_groups{{"", "all cases"}};
  for (const std::string& one : groups) of_groups.push_back({one, one});
  std::vector<FilterOption> of_effects{{"", "all effects"}};
  for (const std::string& one : effects) of_effects.push_back({one, in_words(one)});
  std::vector<FilterOption> of_joints{{"", "every joint"}};
  for (const int one : joints) of_joints.push_back({std::to_string(one), std::to_string(one)});
  std::vector<FilterOption> outcomes{{"", "all cases"}};
  for (const auto& [value, words] : kOutcomeFilters) outcomes.push_back({value, words});
  return {{"item", "case"},
          {"name", results_.name},
          {"title", "Benchmark: " + results_.name},
          {"subtitle",
           fmt::format("{} \u00b7 {} cases \u00b7 seed {} \u00b7 {}", input_name(results_file_),
                       results_.cases.size(), results_.base_seed, results_.command)},
          {"heading", "What was found of what was hidden"},
          {"list_heading", "Case by case"},
          {"list_words",
           "A click on a number opens its recordings below, with the robot file that does not know "
           "what is hidden."},
          {"count", results_.cases.size()},
          {"monitors", ordered_json::array()},
          {"filters",
           {filter_json("effect", "Hidden", false, of_effects),
            filter_json("joint", "Joint", false, of_joints),
            filter_json("group", "Cases", false, of_groups),
            filter_json("outcome", "Show", true, outcomes)}}};
}

std::vector<const Case*> BenchmarkView::left_by(const ResultsFilter& filter) const {
  check_filters(filter, state().at("filters"));
  const std::string group = value_of(filter, "group");
  const bool of_effect = !value_of(filter, "effect").empty() || !value_of(filter, "joint").empty();
  std::vector<const Case*> left;
  for (const Case& one : results_.cases) {
    if (!group.empty() && one.group != group) continue;
    const bool has = std::any_of(one.asked.begin(), one.asked.end(),
                                 [&](const Asked& asked) { return is_of(asked, filter); });
    if (!of_effect || has) left.push_back(&one);
  }
  return left;
}

nlohmann::json BenchmarkView::figures(const ResultsFilter& filter) const {
  const std::vector<const Case*> cases = left_by(filter);
  std::vector<const Asked*> asked;
  std::map<std::string, Counts> by_effect;
  std::map<std::string, Counts> by_group;
  Counts whole;
  for (const Case* one : cases) {
    for (const Asked& of : one->asked) {
      if (!is_of(of, filter)) continue;
      asked.push_back(&of);
      by_effect[in_words(of.effect)].take(of);
      by_group[one->group].take(of);
      whole.take(of);
    }
  }
  const auto rows = [&](const std::map<std::string, Counts>& counts) {
    std::vector<std::pair<std::string, Counts>> all(counts.begin(), counts.end());
    if (all.size() > 1) all.emplace_back("all", whole);
    return all;
  };
  report::Page page;
  page.title = results_.name;
  page.verdict.words = words_of_wrong(cases);
  report::Section& found = page.sections.emplace_back();
  found.heading = "Found";
  if (auto chart = found_over_size(asked)) found.blocks.emplace_back(std::move(*chart));
  if (auto chart = times_chart(cases)) found.blocks.emplace_back(std::move(*chart));
  // Half a row would stand empty beside one.
  if (found.blocks.size() == 1) {
    std::get<report::Chart>(found.blocks.front()).width = report::Width::kFull;
  }
  report::Table by_effects = table_of("Effect by effect", "hidden effect", rows(by_effect));
  by_effects.note += " " + words_of_wrong(cases);
  found.blocks.emplace_back(std::move(by_effects));
  report::Section& groups = page.sections.emplace_back();
  groups.heading = "Groups of cases";
  groups.blocks.emplace_back(table_of("Group by group", "cases", rows(by_group)));
  return {{"sections", report::to_json(page).at("sections")}};
}

ordered_json BenchmarkView::runs(const ResultsFilter& filter, std::size_t from) const {
  const std::string wanted = value_of(filter, "outcome");
  ordered_json runs = ordered_json::array();
  std::size_t count = 0;
  for (const Case* one : left_by(filter)) {
    if (!has_outcome(*one, filter, wanted)) continue;
    if (count >= from && runs.size() < kMostRunsAtOnce) runs.push_back(run_json(*one));
    ++count;
  }
  return {{"count", count},
          {"from", from},
          {"most", kMostRunsAtOnce},
          {"columns", {"Case", "Cases", "Hidden", "Said", "Outcome", "Time"}},
          {"runs", std::move(runs)}};
}

SessionFiles BenchmarkView::record(std::int64_t run) {
  const auto found = std::find_if(results_.cases.begin(), results_.cases.end(),
                                  [&](const Case& one) { return one.number == run; });
  if (found == results_.cases.end()) refuse_filter("There is no such case.");
  if (found->folder.empty()) {
    throw Refused(Refused::Why::kNotNow,
                  "The recordings of the cases were not written: run the benchmark with --write "
                  "FOLDER beside --results.");
  }
  const std::filesystem::path folder =
      std::filesystem::path(results_file_).parent_path() / found->folder;
  const auto named = [&](const char* name) {
    const std::string path = (folder / name).string();
    return NamedFile{path, path};
  };
  std::error_code ignored;
  SessionFiles files;
  files.robot = named("robot.toml");
  files.logs = {named("recording.csv")};
  if (std::filesystem::exists(folder / "holdout.csv", ignored)) {
    files.holdout = {named("holdout.csv")};
  }
  return files;
}

}  // namespace offnominal::desk::studio
