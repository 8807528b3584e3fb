#pragma once

#include <cstdint>
#include <string>

#include "benchmark/benchmark_file.hpp"

namespace offnominal::test {

inline desk::benchmark::Asked asked(const std::string& effect, int joint, int class_size,
                                    double share) {
  using desk::benchmark::Outcome;
  const Outcome outcome = class_size == 0   ? Outcome::kMissed
                          : class_size == 1 ? Outcome::kNamed
                                            : Outcome::kInClass;
  return {effect, joint, share, outcome, class_size, class_size == 0 ? "explained" : ""};
}

// Thirty cases with friction on one of two joints, of which the smallest are missed; one with
// something that is not there, one without an answer.
inline desk::benchmark::Results benchmark_results() {
  using namespace desk::benchmark;
  Results all{"discovery", "./dev bench discovery --seed 5", 5, {}};
  for (int i = 0; i < 30; ++i) {
    Case one;
    one.number = i;
    one.group = i % 2 == 0 ? "single" : "small";
    one.seed = 0xffffffffffffff00U + static_cast<std::uint64_t>(i);
    one.hidden = "coulomb_friction@" + std::to_string(i % 2 + 1);
    one.said = i < 6 ? "nothing" : "coulomb_friction@" + std::to_string(i % 2 + 1);
    one.verdict = i < 6 ? "explained" : "found";
    one.time_s = 0.5 + 0.1 * i;
    one.asked = {asked("coulomb_friction", i % 2 + 1, i < 6 ? 0 : i < 9 ? 2 : 1, 0.01 * (i + 1))};
    one.folder = i == 4 ? "cases/small-004" : "";
    all.cases.push_back(one);
  }
  all.cases[20].wrong = {"backlash@1"};
  all.cases[21].failed = "the <robot> was lost";
  return all;
}

}  // namespace offnominal::test
