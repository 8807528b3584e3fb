#include "arm_bench.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <mutex>
#include <nlohmann/json.hpp>
#include <vector>

#include "arm_outcome.hpp"
#include "arm_summary.hpp"
#include "common/parallel.hpp"

namespace offnominal::bench {

namespace {

using ArmOutcomes = std::vector<std::vector<ArmOutcome>>;  // per group and case

std::vector<ArmGroup> chosen_arm_groups(const ArmBenchOptions& options) {
  std::vector<ArmGroup> chosen;
  std::string names;
  for (ArmGroup& group : arm_groups(options.seed, options.quick)) {
    names += (names.empty() ? "" : ", ") + group.name;
    if (!options.cases.empty() && group.name != options.cases) continue;
    if (group.requests.size() > static_cast<std::size_t>(options.most)) {
      group.requests.resize(static_cast<std::size_t>(options.most));
    }
    chosen.push_back(std::move(group));
  }
  if (chosen.empty()) {
    throw CLI::ValidationError("--cases", "found `" + options.cases + "`, allowed are " + names);
  }
  return chosen;
}

ArmOutcomes outcomes_of(const std::vector<ArmGroup>& groups, int threads) {
  struct Place {
    std::size_t group, number;
  };
  std::vector<Place> places;
  ArmOutcomes outcomes;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    outcomes.emplace_back(groups[g].requests.size());
    for (std::size_t i = 0; i < groups[g].requests.size(); ++i) places.push_back({g, i});
  }
  const bool shows_progress = isatty(STDERR_FILENO) != 0;
  std::mutex output;
  std::size_t done = 0;
  desk::parallel_for(places.size(), threads, [&](std::size_t i) {
    const Place& at = places[i];
    outcomes[at.group][at.number] = run_arm_case(groups[at.group].requests[at.number]);
    const std::lock_guard lock(output);
    ++done;
    if (shows_progress) {
      fmt::print(stderr, "\r{} of {}: {:<40}", done, places.size(), groups[at.group].words);
    }
  });
  if (shows_progress) fmt::print(stderr, "\r{:<60}\r", "");
  return outcomes;
}

void print_arm_text(const ArmBenchOptions& options, const std::vector<ArmGroup>& groups,
                    const ArmOutcomes& outcomes) {
  const std::vector<ArmSummary> lines = summarise_arms(groups, outcomes);
  fmt::print("base seed {}{}\n\n{}", options.seed, options.quick ? ", quick" : "", table_of(lines));
  fmt::print("\n{}", table_of(summarise_arm_effects(outcomes)));
  fmt::print("\n{}", table_of(arm_goals_of(lines)));
  if (!options.failures) return;
  fmt::print("\n");
  for (std::size_t g = 0; g < groups.size(); ++g) {
    fmt::print("{}", failures_of(groups[g], outcomes[g]));
  }
}

void print_arm_json(const ArmBenchOptions& options, const std::vector<ArmGroup>& groups,
                    const ArmOutcomes& outcomes) {
  nlohmann::ordered_json document{{"base_seed", options.seed}, {"quick", options.quick}};
  document["table"] = nlohmann::ordered_json::array();
  for (const ArmSummary& line : summarise_arms(groups, outcomes)) {
    document["table"].push_back(json_of(line));
  }
  document["cases"] = nlohmann::ordered_json::array();
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (const ArmOutcome& one : outcomes[g]) {
      document["cases"].push_back(json_of(groups[g], one));
    }
  }
  fmt::print("{}\n", document.dump(1));
}

}  // namespace

void run_arm_bench(const ArmBenchOptions& options) {
  const std::vector<ArmGroup> groups = chosen_arm_groups(options);
  const ResultsRequest& results = options.results;
  if (!results.cases.empty() && results.file.empty()) {
    for (const auto& folder : write_arm_cases(groups, results.cases)) {
      fmt::print("written: {}\n", folder.string());
    }
    return;
  }
  check_results(results);
  const ArmOutcomes outcomes = outcomes_of(groups, options.threads);
  if (options.json) {
    print_arm_json(options, groups, outcomes);
  } else {
    print_arm_text(options, groups, outcomes);
  }
  if (!results.file.empty()) write_results(results, groups, outcomes);
}

}  // namespace offnominal::bench
