#pragma once

#include <map>
#include <string>
#include <vector>

#include "outcome.hpp"
#include "rate.hpp"

namespace offnominal::bench {

// One line of the table: one method on one group.
struct Summary {
  std::string group;  // as for --cases
  std::string words;
  std::string method;
  CaseGroup::Kind kind = CaseGroup::Kind::kEffects;
  int cases = 0;
  int refused = 0;  // by the simulator
  Rate first, sure, in_class, all_named, wrong;
  Rate parameters;      // within 10 % of the truth, one by one
  Rate all_parameters;  // all of a case
  Rate covered;         // by the 95 % interval
  Rate holdout;         // hold-out error up to 1.2 times the noise floor
  Rate right_verdict, right_detail;
  Rate class_or_undecided;  // in the class, or not_excited, ambiguous, and nothing wrong
  std::map<std::string, int> verdicts;
  double median_s = 0;
  double worst_s = 0;
};

// explain() first; then, where the group has them, the two baselines.
std::vector<Summary> summarise(const CaseGroup& group, const std::vector<Outcome>& outcomes);

// What became of each effect in a group of single effects.
struct EffectSummary {
  std::string effect;
  Rate first, sure, in_class, parameters, covered, stepwise, thresholded;
  std::map<std::string, int> instead;  // what was named first, or the verdict where nothing was
};
std::vector<EffectSummary> summarise_effects(const std::vector<Outcome>& outcomes);

}  // namespace offnominal::bench
