// The blind benchmark of `offnominal explain`; docs/discovery-benchmark.md says how it is made.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "arm_bench.hpp"
#include "case_groups.hpp"
#include "common/parallel.hpp"
#include "outcome.hpp"
#include "results.hpp"
#include "scale.hpp"
#include "tables.hpp"
#include "write_cases.hpp"

namespace offnominal::bench {
namespace {

struct Options {
  bool quick = false;
  bool json = false;
  bool failures = false;
  std::string cases;    // empty: all
  std::string write;    // folder that gets the cases; empty: none
  std::string results;  // file of --benchmark, of a run; empty: none, and cases are written alone
  bool force = false;
  bool arm = false;
  bool scale = false;
  ScaleRequest scale_request;
  int most = 1000;  // cases of each group
  std::uint64_t seed = 20261121;
  int threads = static_cast<int>(std::thread::hardware_concurrency());
};

struct Results {
  std::vector<CaseGroup> groups;
  std::vector<std::vector<Outcome>> outcomes;  // per group and case
};

// The groups that were asked for: by name, or by its part before the dash.
std::vector<CaseGroup> chosen_groups(const Options& options) {
  std::vector<CaseGroup> chosen;
  std::string names;
  for (CaseGroup& group : case_groups(options.seed, options.quick)) {
    names += (names.empty() ? "" : ", ") + group.name;
    const bool wanted = options.cases.empty() || group.name == options.cases ||
                        group.name.starts_with(options.cases + "-");
    if (!wanted) continue;
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

Results run(const Options& options) {
  Results results{chosen_groups(options), {}};
  std::size_t total = 0;
  for (const CaseGroup& group : results.groups) {
    total += group.requests.size();
    results.outcomes.emplace_back(group.requests.size());
  }
  const bool shows_progress = isatty(STDERR_FILENO) != 0;
  std::mutex output;
  std::size_t done = 0;
  for (std::size_t g = 0; g < results.groups.size(); ++g) {
    const CaseGroup& group = results.groups[g];
    desk::parallel_for(group.requests.size(), options.threads, [&](std::size_t i) {
      results.outcomes[g][i] = run_case(group, group.requests[i]);
      const std::lock_guard lock(output);
      ++done;
      if (shows_progress) fmt::print(stderr, "\r{} of {}: {:<40}", done, total, group.words);
    });
  }
  if (shows_progress) fmt::print(stderr, "\r{:<60}\r", "");
  return results;
}

void print_text(const Options& options, const Results& results) {
  std::vector<Summary> lines;
  for (std::size_t g = 0; g < results.groups.size(); ++g) {
    for (Summary& line : summarise(results.groups[g], results.outcomes[g])) {
      lines.push_back(std::move(line));
    }
  }
  fmt::print("base seed {}{}\n\n{}", options.seed, options.quick ? ", quick" : "", table_of(lines));
  for (std::size_t g = 0; g < results.groups.size(); ++g) {
    if (results.groups[g].name != "single") continue;
    fmt::print("\n{}", table_of(summarise_effects(results.outcomes[g])));
  }
  fmt::print("\n{}", table_of(goals_of(lines)));
  if (!options.failures) return;
  fmt::print("\n");
  for (std::size_t g = 0; g < results.groups.size(); ++g) {
    fmt::print("{}", failures_of(results.groups[g], results.outcomes[g]));
  }
}

void print_json(const Options& options, const Results& results) {
  nlohmann::ordered_json document{{"base_seed", options.seed}, {"quick", options.quick}};
  document["table"] = nlohmann::ordered_json::array();
  document["cases"] = nlohmann::ordered_json::array();
  for (std::size_t g = 0; g < results.groups.size(); ++g) {
    for (const Summary& line : summarise(results.groups[g], results.outcomes[g])) {
      document["table"].push_back(json_of(line));
    }
    for (const Outcome& one : results.outcomes[g]) {
      document["cases"].push_back(json_of(results.groups[g], one));
    }
  }
  fmt::print("{}\n", document.dump(1));
}

// What repeats the run.
std::string command_of(const Options& options) {
  std::string command = fmt::format("./dev bench discovery --seed {}", options.seed);
  if (options.arm) command += " --arm";
  if (options.quick) command += " --quick";
  if (!options.cases.empty()) command += " --cases " + options.cases;
  const Options usual;
  if (options.most != usual.most) command += fmt::format(" --most {}", options.most);
  return command;
}

ResultsRequest results_of(const Options& options) {
  return {options.results, options.write, command_of(options), options.seed, options.force};
}

void run_scale(const Options& options) {
  ScaleRequest request = options.scale_request;
  request.seed = options.seed;
  request.threads = options.threads;
  if (!options.write.empty()) {
    write_scale(request, options.write);
    fmt::print("written: {}\n", options.write);
    return;
  }
  const ScaleOutcome outcome = run_scale(request);
  if (options.json) {
    fmt::print("{}\n", json_of(request, outcome).dump(1));
  } else {
    fmt::print("{}", text_of(request, outcome));
  }
}

void run_arm(const Options& options) {
  run_arm_bench({.quick = options.quick,
                 .json = options.json,
                 .failures = options.failures,
                 .cases = options.cases,
                 .results = results_of(options),
                 .most = options.most,
                 .seed = options.seed,
                 .threads = options.threads});
}

int main_of(int argc, char** argv) {
  Options options;
  CLI::App app("Blind benchmark of the search for missing effects", "./dev bench discovery");
  app.add_flag("--quick", options.quick, "a few cases of each group, less than two minutes");
  app.add_option("--cases", options.cases, "one group, by the name that --json prints");
  app.add_option("--most", options.most, "only the first of each group")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--seed", options.seed, "base of every case's seed")->capture_default_str();
  app.add_option("--threads", options.threads, "cases that run at once")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_option("--write", options.write,
                 "write the chosen cases as robot files and recordings into this folder, and what "
                 "they hide beside them; nothing is run, unless --results asks for it");
  app.add_option(
      "--results", options.results,
      "write what came of every case into this file, for `offnominal studio --benchmark`; "
      "with --write its cases can be opened there");
  app.add_flag("--force", options.force, "--results may replace a file");
  CLI::Option* arm = app.add_flag("--arm", options.arm,
                                  "arms of six and seven joints in MuJoCo, judged joint by joint");
  CLI::Option* scale = app.add_flag(
      "--scale", options.scale,
      "one long recording of a seven-joint arm in place of the cases: time and memory of explain");
  scale->excludes(arm)->excludes("--results");
  app.add_option("--samples", options.scale_request.samples, "of that recording, at 1 kHz")
      ->check(CLI::Range(10'000, 10'000'000))
      ->capture_default_str()
      ->needs(scale);
  app.add_flag("--failures", options.failures, "list every case that was not answered rightly");
  app.add_flag("--json", options.json, "everything as JSON, case by case");
  try {
    app.parse(argc, argv);
    if (options.scale) {
      run_scale(options);
      return 0;
    }
    if (options.arm) {
      run_arm(options);
      return 0;
    }
    if (!options.write.empty() && options.results.empty()) {
      for (const auto& folder : write_cases(chosen_groups(options), options.write)) {
        fmt::print("written: {}\n", folder.string());
      }
      return 0;
    }
    check_results(results_of(options));
    const Results results = run(options);
    if (options.json) {
      print_json(options, results);
    } else {
      print_text(options, results);
    }
    if (!options.results.empty()) {
      write_results(results_of(options), results.groups, results.outcomes);
    }
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return 0;
}

}  // namespace
}  // namespace offnominal::bench

int main(int argc, char** argv) {
  try {
    return offnominal::bench::main_of(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "offnominal_bench_discovery: %s\n", error.what());
    return 2;
  }
}
