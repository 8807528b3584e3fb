#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "arm_case.hpp"
#include "arm_judge.hpp"

namespace offnominal::bench {

// What came of one case.
struct ArmOutcome {
  ArmRequest request;
  std::string refused;  // why the simulator refused it; then nothing else is set
  std::string failed;   // what reading or explain() threw
  ArmTruth truth;
  std::string verdict;
  std::vector<desk::EffectAt> named;
  std::vector<std::vector<desk::EffectAt>> classes;
  ArmScore score;
  double time_s = 0;  // of explain() alone
};

// Simulates one case, reads its recordings as files are read, and lets the analysis say what is
// hidden, on one thread unless the options say otherwise.
ArmOutcome run_arm_case(const ArmRequest& request, const desk::ExplainOptions& options = {});

// Writes every case as its owner would have it, into a new folder GROUP-NUMBER of `folder` each:
// robot.toml, recording.csv, holdout.csv where there is one, and truth.json with what is hidden.
// Returns the folders. Throws desk::InputError where one of them is there already or cannot be
// written.
std::vector<std::filesystem::path> write_arm_cases(const std::vector<ArmGroup>& groups,
                                                   const std::filesystem::path& folder);

nlohmann::ordered_json json_of(const ArmTruth& truth);
nlohmann::ordered_json json_of(const ArmGroup& group, const ArmOutcome& outcome);

// "coulomb_friction@2": effect and joint, from 1.
std::string name_at(const desk::EffectAt& one);

// "coulomb_friction@2 6.1 %, push@5 at 12.31 s": what is hidden, in one line.
std::string text_of(const ArmTruth& truth);

}  // namespace offnominal::bench
