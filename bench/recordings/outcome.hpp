#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "expected_case.hpp"

namespace offnominal::bench {

// One joint of one case.
struct JointOutcome {
  int joint = 0;  // from 1
  std::string verdict;
  std::string found;          // what is named, with classes
  double before_percent = 0;  // of the joint's torque
  double after_percent = 0;
};

struct Outcome {
  std::vector<std::string> missing;  // files that are not there; then nothing was run
  std::string refusal;               // what explain would not take
  std::string verdict;
  std::vector<JointOutcome> joints;
  std::vector<char> reached;  // per claim
  double seconds = 0;
};

// What explain says of the case's recordings, held against its claims. A recording that is refused
// reaches no claim.
[[nodiscard]] Outcome run_case(const ExpectedCase& expected,
                               const std::filesystem::path& recordings,
                               const std::filesystem::path& robots, int threads);

}  // namespace offnominal::bench
