#pragma once

#include <optional>
#include <string>
#include <vector>

#include "baselines.hpp"
#include "case_groups.hpp"
#include "explain/explain.hpp"
#include "score.hpp"

namespace offnominal::bench {

// A parameter of a true effect that was named.
struct ParameterCheck {
  std::string name;
  double truth = 0;
  double estimate = 0;
  bool within_tenth = false;
  std::optional<bool> covered;  // by the 95 % interval; none where there is no interval
};

// What came of one case.
struct Outcome {
  sim::hidden::Request request;
  std::string refused;  // why the simulator refused it; then nothing else is set
  std::string failed;   // what explain() threw
  Effects truth;
  std::string hidden;  // in words: effects with joints, or what else is hidden
  std::string verdict;
  std::string before;  // kMotion: the verdict on the first motion, and the class
  Effects named;
  std::vector<Effects> classes;
  Effects suspected;  // at most one
  Score score;
  std::vector<ParameterCheck> parameters;
  double holdout_ratio = 0;    // hold-out error to the noise floor, of the worst joint
  bool right_verdict = false;  // outside of the list, or a fault of the recording
  bool right_detail = false;   // ... with the variable, or the kind of fault
  double time_s = 0;           // of explain() alone
  std::optional<BaselineSelections> baselines;
};

// What explain() names, classes and suspects, and its score against outcome.truth.
void take_verdict(const desk::Explanation& explanation, Outcome& outcome);

// Simulates one case and lets the analysis, on one thread, say what is hidden.
Outcome run_case(const CaseGroup& group, const sim::hidden::Request& request);

// "coulomb_friction@2", joints from 1.
std::string text_of(const desk::EffectAt& effect);
std::string text_of(const Effects& effects);

}  // namespace offnominal::bench
