#include "outcome.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <string_view>

#include "motion_case.hpp"
#include "recorded_case.hpp"
#include "true_parameters.hpp"
#include "wall_clock.hpp"

namespace offnominal::bench {

namespace hidden = sim::hidden;
using desk::EffectAt;
using desk::Explanation;
using desk::Verdict;

namespace {

std::string text_at(std::string_view name, Eigen::Index joint) {
  return fmt::format("{}@{}", name, joint + 1);
}

EffectAt place_of(const hidden::TrueEffect& effect) {
  return {info_named(hidden::name(effect.effect))->kind, effect.joint};
}

std::string words_for(const hidden::Truth& truth, const Effects& effects) {
  if (truth.fault != hidden::DataFault::kNone) return std::string(hidden::name(truth.fault));
  if (truth.outside.effect == hidden::OutsideEffect::kNone) return text_of(effects);
  return text_at(hidden::name(truth.outside.effect), truth.outside.joint);
}

ParameterCheck check(const ExpectedParameter& expected, const desk::Estimate& found) {
  constexpr double kTenth = 0.1;
  ParameterCheck result{expected.name, expected.value, found.value.value, false, std::nullopt};
  result.within_tenth = std::abs(result.estimate - result.truth) <= kTenth * expected.scale;
  if (found.ci95) {
    result.covered = result.truth >= (*found.ci95)[0] && result.truth <= (*found.ci95)[1];
  }
  return result;
}

void check_parameters(const hidden::Truth& truth, const Explanation& e, double period_s,
                      Outcome& outcome) {
  for (const hidden::TrueEffect& effect : truth.effects) {
    for (const auto& finding : e.found) {
      if (!(finding.what == place_of(effect))) continue;
      for (const ExpectedParameter& expected : expected_parameters(effect, period_s)) {
        for (const auto& estimate : finding.parameters) {
          if (estimate.value.name != expected.name) continue;
          outcome.parameters.push_back(check(expected, estimate));
        }
      }
    }
  }
}

bool is_unknown(Verdict verdict) {
  return verdict == Verdict::kUnknownStateDependent || verdict == Verdict::kUnknownExternal;
}

void judge_outside(const hidden::TrueOutsideEffect& outside, const Explanation& e,
                   Outcome& outcome) {
  outcome.right_verdict = is_unknown(e.verdict);
  const std::string variable(hidden::row_of(outside.effect).variable);
  if (!outcome.right_verdict || variable == "time") {
    outcome.right_detail = e.verdict == Verdict::kUnknownExternal && variable == "time";
    return;
  }
  if (e.verdict != Verdict::kUnknownStateDependent) return;
  for (const auto& share : e.where) {  // largest first
    if (share.joint != outside.joint || share.variable == "time") continue;
    outcome.right_detail = share.variable == variable;
    return;
  }
}

std::optional<desk::DataFaultKind> kind_of(hidden::DataFault fault) {
  using desk::DataFaultKind;
  switch (fault) {
    case hidden::DataFault::kDegrees:
      return DataFaultKind::kDegrees;
    case hidden::DataFault::kSwappedTorqueSign:
      return DataFaultKind::kTorqueSign;
    case hidden::DataFault::kStaleSamples:
      return DataFaultKind::kStaleSamples;
    case hidden::DataFault::kClockSkew:
      return DataFaultKind::kClockSkew;
    case hidden::DataFault::kNone:
      break;
  }
  return std::nullopt;
}

void judge_fault(hidden::DataFault fault, const Explanation& e, Outcome& outcome) {
  const auto has = [&](const std::vector<desk::DataFault>& faults) {
    return std::any_of(faults.begin(), faults.end(),
                       [&](const auto& one) { return one.kind == kind_of(fault); });
  };
  // What is left out is named as well, and no reason to stop.
  const bool left_out = has(e.left_out);
  outcome.right_verdict = e.verdict == Verdict::kDataFault || left_out;
  outcome.right_detail = outcome.right_verdict && (left_out || has(e.data_faults));
}

void judge(const CaseGroup& group, const hidden::Case& made, const Explanation& e,
           Outcome& outcome) {
  take_verdict(e, outcome);
  // A shift of a number of the file that is right is as wrong as an effect that is not there.
  outcome.score.wrong |= e.verdict == Verdict::kParameterShift && e.found.empty();
  check_parameters(made.truth, e, made.recording.t_s[1] - made.recording.t_s[0], outcome);
  outcome.holdout_ratio = 0;
  for (const auto& joint : e.joints) {
    outcome.holdout_ratio =
        std::max(outcome.holdout_ratio, joint.holdout_fitted / joint.holdout_noise_floor);
  }
  if (group.kind == CaseGroup::Kind::kOutside) judge_outside(made.truth.outside, e, outcome);
  if (group.kind == CaseGroup::Kind::kDataFault) judge_fault(made.truth.fault, e, outcome);
}

}  // namespace

void take_verdict(const Explanation& e, Outcome& outcome) {
  outcome.verdict = desk::name_of(e.verdict);
  for (const auto& finding : e.found) outcome.named.push_back(finding.what);
  outcome.classes = e.ambiguous;
  if (e.suspected) outcome.suspected = {e.suspected->what};
  outcome.score = score_of(outcome.truth, outcome.named, outcome.classes);
}

Outcome run_case(const CaseGroup& group, const hidden::Request& request) {
  if (group.kind == CaseGroup::Kind::kMotion) return run_motion_case(request);
  Outcome outcome;
  outcome.request = request;
  hidden::Case made;
  try {
    made = hidden::make_case(request);
  } catch (const std::exception& error) {
    outcome.refused = error.what();
    return outcome;
  }
  for (const auto& effect : made.truth.effects) outcome.truth.push_back(place_of(effect));
  outcome.hidden = words_for(made.truth, outcome.truth);
  const desk::RobotDescription robot = robot_of(made.nominal);
  const desk::Log recording = log_of(made.recording);
  try {
    const double start_s = now_s();
    const Explanation e = desk::explain(robot, {recording}, {log_of(made.holdout)}, {});
    outcome.time_s = now_s() - start_s;
    judge(group, made, e, outcome);
    if (group.with_baselines) outcome.baselines = select_by_baselines(robot, recording);
  } catch (const std::exception& error) {
    outcome.failed = error.what();
    outcome.verdict = "error";
  }
  return outcome;
}

std::string text_of(const EffectAt& effect) { return text_at(effect.name(), effect.joint); }

std::string text_of(const Effects& effects) {
  std::string text;
  for (const EffectAt& one : effects) text += (text.empty() ? "" : ", ") + text_of(one);
  return text.empty() ? "none" : text;
}

}  // namespace offnominal::bench
