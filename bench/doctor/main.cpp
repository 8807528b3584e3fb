// How often the doctor is right about recordings; docs/recordings.md says how they are made.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "common/parallel.hpp"
#include "doctor_case.hpp"

namespace offnominal::bench {
namespace {

struct Options {
  int cases = 500;  // of each family
  int first = 0;
  std::uint64_t seed = 20261124;
  int threads = static_cast<int>(std::thread::hardware_concurrency());
  bool developed = true;
  bool held_out = true;
  bool failures = false;
};

struct Count {
  int right = 0;
  int all = 0;
};

Count run(Family family, const Options& options) {
  struct Result {
    std::string defect, line;
    bool right = false;
  };
  std::vector<Result> results(static_cast<std::size_t>(options.cases));
  desk::parallel_for(results.size(), options.threads, [&](std::size_t i) {
    const int number = options.first + static_cast<int>(i);
    DoctorCase made = make_doctor_case(family, options.seed, number);
    const Judgement judgement = judge(made, desk::treat(made.log, made.robot));
    results[i] = {std::string(name_of(made.truth.kind)),
                  fmt::format("  {}: {} of joint {} at {:.3f} to {:.3f} s, said \"{}\" ({})",
                              number, name_of(made.truth.kind), made.truth.joint + 1,
                              made.truth.from_s, made.truth.to_s, judgement.said, made.words),
                  judgement.right};
  });
  std::map<std::string, Count> counts;
  Count whole;
  for (const Result& result : results) {
    Count& count = counts[result.defect];
    ++count.all;
    ++whole.all;
    count.right += result.right ? 1 : 0;
    whole.right += result.right ? 1 : 0;
    if (!result.right && options.failures) fmt::print("{}\n", result.line);
  }
  for (const auto& [name, count] : counts) {
    fmt::print("  {:<15} {:>4} of {:>4}\n", name, count.right, count.all);
  }
  fmt::print("{}: {} of {} right, {:.1f} %\n",
             family == Family::kDeveloped ? "developed on" : "held out", whole.right, whole.all,
             100.0 * whole.right / whole.all);
  return whole;
}

int run(const Options& options) {
  fmt::print("seed {}\n", options.seed);
  if (options.developed) run(Family::kDeveloped, options);
  if (options.held_out) run(Family::kHeldOut, options);
  return 0;
}

}  // namespace
}  // namespace offnominal::bench

int main(int argc, char** argv) {
  using offnominal::bench::Options;
  CLI::App app("How often the doctor is right about recordings with and without faults");
  Options options;
  std::string family = "both";
  app.add_option("--cases", options.cases, "Recordings of each family")
      ->check(CLI::Range(1, 100000));
  app.add_option("--first", options.first, "Number of the first");
  app.add_option("--seed", options.seed, "Seed of all draws");
  app.add_option("--threads", options.threads)->check(CLI::Range(1, 256));
  app.add_option("--family", family)->check(CLI::IsMember({"developed", "held-out", "both"}));
  app.add_flag("--failures", options.failures, "Name the wrong ones");
  CLI11_PARSE(app, argc, argv);
  options.developed = family != "held-out";
  options.held_out = family != "developed";
  try {
    return offnominal::bench::run(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
