#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "arm_outcome.hpp"
#include "goal.hpp"
#include "rate.hpp"

namespace offnominal::bench {

// One line of the table: what became of a group.
struct ArmSummary {
  std::string group;  // as for --cases; "all": everything that hides something
  std::string words;
  int cases = 0;
  int refused = 0;   // by the simulator
  int failed = 0;    // not read, or not explained
  Rate answered;     // of the joints that miss something, those that got it named, or in a class
  Rate wrong;        // of all joints, those with something named that is not there
  Rate wrong_cases;  // of the recordings
  Rate payload;      // mass within 10 %
  Rate moment;       // of a change or of pushes, within 0.1 s
  std::vector<int> class_sizes;  // of effects that were asked for and got an answer
  std::map<std::string, int> verdicts;
  std::vector<double> times_s;
};

// What became of one effect in all groups.
struct ArmEffectSummary {
  std::string effect;
  Rate named;     // alone
  Rate in_class;  // ... or in a class of at most three
  std::map<std::string, int> instead;
};

// Per group, and last a line of all that hide something where there are several of them.
std::vector<ArmSummary> summarise_arms(const std::vector<ArmGroup>& groups,
                                       const std::vector<std::vector<ArmOutcome>>& outcomes);
std::vector<ArmEffectSummary> summarise_arm_effects(
    const std::vector<std::vector<ArmOutcome>>& outcomes);
std::vector<Goal> arm_goals_of(const std::vector<ArmSummary>& lines);

// Markdown tables.
std::string table_of(const std::vector<ArmSummary>& lines);
std::string table_of(const std::vector<ArmEffectSummary>& effects);
// Every case that was not answered rightly: how to run it again and what was said.
std::string failures_of(const ArmGroup& group, const std::vector<ArmOutcome>& outcomes);

nlohmann::ordered_json json_of(const ArmSummary& line);

}  // namespace offnominal::bench
