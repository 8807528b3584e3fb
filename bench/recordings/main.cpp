// Real recordings as a table: what explain says of each, and whether that is known to be so.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "common/error.hpp"
#include "common/file.hpp"
#include "common/nearest.hpp"
#include "common/text_table.hpp"
#include "expected_case.hpp"
#include "outcome.hpp"

namespace offnominal::bench {
namespace {

constexpr int kSkipped = 77;  // what CTest takes for it

struct Options {
  std::string data;
  std::string expectations = OFFNOMINAL_RECORDINGS "/expectations.toml";
  std::string misses = OFFNOMINAL_RECORDINGS "/known_misses.txt";
  std::string only;
  bool list_misses = false;
  bool json = false;
  int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
};

struct Judged {
  ExpectedCase expected;
  Outcome outcome;
};

// "case: claim", as known_misses.txt has them.
std::string line_of(const ExpectedCase& expected, const Claim& claim) {
  return expected.name + ": " + claim.text;
}

std::set<std::string> read_misses(const std::string& file) {
  std::set<std::string> misses;
  std::istringstream lines(desk::read_text_file(file));
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && !line.starts_with('#')) misses.insert(line);
  }
  return misses;
}

// What differs from what is known: both directions are worth a look.
struct Differences {
  std::vector<std::string> lost;     // not reached, and not known to be missed
  std::vector<std::string> gained;   // reached, though listed as missed
  std::vector<std::string> strange;  // listed, and no claim of any case
};

Differences differences_of(const std::vector<Judged>& all, const std::set<std::string>& misses,
                           bool whole) {
  Differences differences;
  std::set<std::string> claims;
  for (const Judged& one : all) {
    for (std::size_t i = 0; i < one.expected.claims.size(); ++i) {
      const std::string line = line_of(one.expected, one.expected.claims[i]);
      claims.insert(line);
      if (!one.outcome.missing.empty()) continue;
      const bool reached = one.outcome.reached[i] != 0;
      if (!reached && !misses.contains(line)) differences.lost.push_back(line);
      if (reached && misses.contains(line)) differences.gained.push_back(line);
    }
  }
  for (const std::string& line : misses) {
    if (whole && !claims.contains(line)) differences.strange.push_back(line);
  }
  return differences;
}

std::string tally_of(const Judged& one, int joint) {
  int reached = 0;
  int claims = 0;
  for (std::size_t i = 0; i < one.expected.claims.size(); ++i) {
    const auto& of = one.expected.claims[i].joint;
    if (of.value_or(1) != joint) continue;
    ++claims;
    reached += one.outcome.reached[i];
  }
  return claims == 0 ? "-" : fmt::format("{} of {}", reached, claims);
}

void print_table(const std::vector<Judged>& all) {
  const desk::TextTable table({{"recordings", -48},
                               {"robot file", -19},
                               {"joint", -5},
                               {"verdict", -22},
                               {"before", 8},
                               {"after", 8},
                               {"time", 7},
                               {"claims", 8},
                               {"  found, or one of a|b", 0}});
  std::cout << table.heading();
  for (const Judged& one : all) {
    const auto line = [&](const std::string& joint, const std::string& verdict,
                          const std::string& before, const std::string& after,
                          const std::string& claims, const std::string& found) {
      const bool first = joint == "1" || joint.empty();
      std::cout << table.line(
          {first ? one.expected.name : "", first ? one.expected.robot : "", joint, verdict, before,
           after, first ? fmt::format("{:.1f} s", one.outcome.seconds) : "", claims, "  " + found});
    };
    if (!one.outcome.missing.empty()) {
      line("", "skipped", "", "", "", "not there: " + one.outcome.missing.front());
    } else if (!one.outcome.refusal.empty()) {
      line("", "refused", "", "", fmt::format("0 of {}", one.expected.claims.size()),
           one.outcome.refusal);
    }
    for (const JointOutcome& joint : one.outcome.joints) {
      line(std::to_string(joint.joint), joint.verdict,
           fmt::format("{:.1f} %", joint.before_percent),
           fmt::format("{:.1f} %", joint.after_percent), tally_of(one, joint.joint), joint.found);
    }
  }
}

nlohmann::ordered_json json_of(const Judged& one) {
  nlohmann::ordered_json json{{"case", one.expected.name},      {"robot", one.expected.robot},
                              {"logs", one.expected.logs},      {"holdout", one.expected.holdout},
                              {"source", one.expected.source},  {"missing", one.outcome.missing},
                              {"refusal", one.outcome.refusal}, {"verdict", one.outcome.verdict},
                              {"seconds", one.outcome.seconds}};
  json["joints"] = nlohmann::ordered_json::array();
  for (const JointOutcome& joint : one.outcome.joints) {
    json["joints"].push_back({{"joint", joint.joint},
                              {"verdict", joint.verdict},
                              {"found", joint.found},
                              {"before_percent", joint.before_percent},
                              {"after_percent", joint.after_percent}});
  }
  json["claims"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < one.expected.claims.size(); ++i) {
    json["claims"].push_back(
        {{"claim", one.expected.claims[i].text}, {"reached", one.outcome.reached[i] != 0}});
  }
  return json;
}

void print_lines(const char* heading, const std::vector<std::string>& lines) {
  if (lines.empty()) return;
  std::cout << '\n' << heading << '\n';
  for (const std::string& line : lines) std::cout << "  " << line << '\n';
}

int report(const Options& options, const std::vector<Judged>& all, std::size_t claims,
           std::size_t reached) {
  const std::set<std::string> misses = read_misses(options.misses);
  const Differences differences = differences_of(all, misses, options.only.empty());
  const bool as_known =
      differences.lost.empty() && differences.gained.empty() && differences.strange.empty();
  if (options.json) {
    nlohmann::ordered_json json;
    json["cases"] = nlohmann::ordered_json::array();
    for (const Judged& one : all) json["cases"].push_back(json_of(one));
    json["lost"] = differences.lost;
    json["gained"] = differences.gained;
    json["strange"] = differences.strange;
    std::cout << json.dump(2) << '\n';
    return as_known ? 0 : 1;
  }
  print_table(all);
  std::vector<std::string> known;
  for (const Judged& one : all) {
    for (std::size_t i = 0; i < one.expected.claims.size(); ++i) {
      const std::string line = line_of(one.expected, one.expected.claims[i]);
      const bool ran = one.outcome.missing.empty();
      if (ran && one.outcome.reached[i] == 0 && misses.contains(line)) known.push_back(line);
    }
  }
  print_lines("missed, as known_misses.txt says:", known);
  print_lines("missed, and known to have been reached:", differences.lost);
  print_lines("reached, though known_misses.txt has it: take it out there", differences.gained);
  print_lines("in known_misses.txt, and no claim of expectations.toml:", differences.strange);
  std::cout << fmt::format("\n{} of {} claims reached{}\n", reached, claims,
                           as_known ? "" : ": not what is known");
  return as_known ? 0 : 1;
}

int run(const Options& options) {
  std::vector<Judged> all;
  for (ExpectedCase& expected : read_expectations(options.expectations)) {
    if (!options.only.empty() && expected.name.find(options.only) == std::string::npos) continue;
    Outcome outcome = run_case(expected, options.data, OFFNOMINAL_ROBOTS, options.threads);
    all.push_back({std::move(expected), std::move(outcome)});
  }
  std::size_t claims = 0;
  std::size_t reached = 0;
  for (const Judged& one : all) {
    if (!one.outcome.missing.empty()) continue;
    claims += one.expected.claims.size();
    for (std::size_t i = 0; i < one.expected.claims.size(); ++i) {
      const bool is = one.outcome.reached[i] != 0;
      reached += is ? 1 : 0;
      if (options.list_misses && !is) {
        std::cout << line_of(one.expected, one.expected.claims[i]) << '\n';
      }
    }
  }
  if (options.list_misses) return 0;
  if (claims == 0) {
    print_table(all);
    std::cout << fmt::format("\nskipped: no case's recordings are in {}\n", options.data);
    return kSkipped;
  }
  return report(options, all, claims, reached);
}

int main_of(int argc, char** argv) {
  Options options;
  const char* const data = std::getenv("OFFNOMINAL_DATA");
  options.data =
      data != nullptr && *data != '\0'
          ? data
          : std::filesystem::path(OFFNOMINAL_ROBOTS "/../../shared/data").lexically_normal();
  CLI::App app("What explain says of recordings of real machines, against what is known of them",
               "offnominal_bench_recordings");
  app.add_option("--data", options.data, "Folder of the recordings")->capture_default_str();
  app.add_option("--expectations", options.expectations, "What is known of them")
      ->capture_default_str();
  app.add_option("--misses", options.misses, "What of it is not reached yet")
      ->capture_default_str();
  app.add_option("--only", options.only, "Cases with this in their name");
  app.add_option("--threads", options.threads, "Threads")->check(CLI::Range(1, 256));
  app.add_flag("--list-misses", options.list_misses,
               "Print what is missed, as known_misses.txt lists it, and nothing else");
  app.add_flag("--json", options.json, "Print one JSON object and nothing else");
  app.footer(
      "Exit code 1 where a claim is missed that is not in known_misses.txt, or reached that is; 77 "
      "where no recording is there.");
  CLI11_PARSE(app, argc, argv);
  return run(options);
}

}  // namespace
}  // namespace offnominal::bench

int main(int argc, char** argv) {
  try {
    return offnominal::bench::main_of(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "offnominal_bench_recordings: " << error.what() << '\n';
    return 2;
  }
}
