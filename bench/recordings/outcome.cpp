#include "outcome.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/error.hpp"
#include "common/nearest.hpp"
#include "explain/explain.hpp"
#include "log/read_log.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::bench {
namespace {

using desk::EffectAt;
using desk::Explanation;
using desk::Finding;

constexpr std::size_t kLargestClass = 3;

bool is_on(Eigen::Index joint, const Claim& claim) {
  return !claim.joint || joint + 1 == *claim.joint;
}

bool is_one_of(std::string_view word, const std::vector<std::string>& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

double value_of(const Finding& finding, const std::string& parameter) {
  for (const desk::Estimate& one : finding.parameters) {
    if (one.value.name == parameter) return one.value.value;
  }
  return std::nan("");
}

bool names(const Explanation& e, const Claim& claim) {
  for (const Finding& one : e.found) {
    if (!is_on(one.what.joint, claim) || !is_one_of(one.what.name(), claim.words)) continue;
    constexpr double kSameOrder = 0.25;
    if (!claim.order || std::abs(value_of(one, "order") - *claim.order) < kSameOrder) return true;
  }
  if (claim.order) return false;
  return std::any_of(e.ambiguous.begin(), e.ambiguous.end(), [&](const auto& same) {
    return same.size() <= kLargestClass &&
           std::any_of(same.begin(), same.end(), [&](const EffectAt& one) {
             return is_on(one.joint, claim) && is_one_of(one.name(), claim.words);
           });
  });
}

// What stands for a class, whose members are alike, is no claim of its own.
bool is_found(const Explanation& e, const Finding& one) {
  return !desk::holds_in_any(e.ambiguous, one.what);
}

bool finds_any(const Explanation& e, const Claim& claim) {
  return std::any_of(e.found.begin(), e.found.end(), [&](const Finding& one) {
    const bool meant = claim.words.empty() || is_one_of(one.what.name(), claim.words);
    return is_on(one.what.joint, claim) && meant && is_found(e, one);
  });
}

bool number_is_within(const Explanation& e, const Claim& claim) {
  const auto dot = claim.words[0].find('.');
  for (const Finding& one : e.found) {
    if (!is_on(one.what.joint, claim) || one.what.name() != claim.words[0].substr(0, dot)) continue;
    const double value = value_of(one, claim.words[0].substr(dot + 1));
    return value >= claim.from && value <= claim.to;
  }
  return false;
}

// Of what compare() makes of a file; of a hold map, what the fit leaves.
double left_of(const Explanation& e, const desk::JointErrors& joint, bool after) {
  if (e.at_rest) return (after ? joint.rms_after : joint.rms_before) / joint.rms_torque;
  return (after ? joint.rms_improved : joint.rms_before) / joint.rms_torque;
}

bool is_reached(const Explanation& e, const Claim& claim) {
  const auto any_answer = [&](const auto& holds) {
    return std::any_of(e.answers.begin(), e.answers.end(), [&](const desk::JointAnswer& one) {
      return is_on(one.joint, claim) && holds(one);
    });
  };
  const auto says_it = [&](const std::vector<desk::DataFault>& faults) {
    return std::any_of(faults.begin(), faults.end(), [&](const desk::DataFault& one) {
      return (one.joint < 0 || is_on(one.joint, claim)) &&
             one.words.find(claim.words[0]) != std::string::npos;
    });
  };
  switch (claim.kind) {
    case Claim::Kind::kNames:
      return names(e, claim);
    case Claim::Kind::kNever:
    case Claim::Kind::kNothingFound:
      return !finds_any(e, claim);
    case Claim::Kind::kNumber:
      return number_is_within(e, claim);
    case Claim::Kind::kLeft:
      return std::any_of(e.joints.begin(), e.joints.end(), [&](const desk::JointErrors& one) {
        return is_on(one.joint, claim) && left_of(e, one, true) <= claim.to;
      });
    case Claim::Kind::kVerdict:
      return any_answer(
          [&](const auto& one) { return is_one_of(name_of(one.verdict), claim.words); });
    case Claim::Kind::kOver:
      return std::any_of(e.over_variable.begin(), e.over_variable.end(),
                         [&](const desk::OverVariable& one) {
                           return is_on(one.joint, claim) && one.variable == claim.words[0];
                         });
    case Claim::Kind::kFault:
      return says_it(e.data_faults) || says_it(e.data_hints) || says_it(e.left_out);
  }
  return false;
}

JointOutcome outcome_of(const Explanation& e, const desk::JointErrors& joint) {
  JointOutcome outcome;
  outcome.joint = static_cast<int>(joint.joint) + 1;
  outcome.verdict = name_of(e.verdict);
  outcome.before_percent = 100 * left_of(e, joint, false);
  outcome.after_percent = 100 * left_of(e, joint, true);
  std::vector<std::string> named;
  for (const desk::JointAnswer& one : e.answers) {
    if (one.joint == joint.joint) outcome.verdict = name_of(one.verdict);
  }
  for (const Finding& one : e.found) {
    if (one.what.joint == joint.joint && is_found(e, one)) named.push_back(title_of(one));
  }
  for (const auto& same : e.ambiguous) {
    if (same.front().joint != joint.joint) continue;
    named.push_back(list_of(same, [](const EffectAt& one) { return std::string(one.name()); }));
    std::replace(named.back().begin(), named.back().end(), ',', '|');
    if (same.size() == 1) named.back() += "|own numbers";
  }
  outcome.found = desk::list_of(named);
  return outcome;
}

}  // namespace

Outcome run_case(const ExpectedCase& expected, const std::filesystem::path& recordings,
                 const std::filesystem::path& robots, int threads) {
  Outcome outcome;
  for (const auto* files : {&expected.logs, &expected.holdout}) {
    for (const std::string& file : *files) {
      if (!std::filesystem::exists(recordings / file)) outcome.missing.push_back(file);
    }
  }
  outcome.reached.assign(expected.claims.size(), 0);
  if (!outcome.missing.empty()) return outcome;
  const auto began = std::chrono::steady_clock::now();
  try {
    const auto robot = desk::read_robot_file(robots / expected.robot);
    const auto read = [&](const std::vector<std::string>& files) {
      std::vector<desk::Log> logs;
      for (const std::string& file : files) {
        logs.push_back(desk::read_log_or_hold_map(recordings / file, robot, {}));
      }
      return logs;
    };
    desk::ExplainOptions options;
    options.threads = threads;
    const Explanation e = explain(robot, read(expected.logs), read(expected.holdout), options);
    outcome.verdict = name_of(e.verdict);
    for (const desk::JointErrors& joint : e.joints) outcome.joints.push_back(outcome_of(e, joint));
    for (std::size_t i = 0; i < expected.claims.size(); ++i) {
      outcome.reached[i] = static_cast<char>(is_reached(e, expected.claims[i]));
    }
  } catch (const desk::InputError& error) {
    outcome.refusal = error.what();
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  outcome.seconds = took.count();
  return outcome;
}

}  // namespace offnominal::bench
