#include "summary.hpp"

#include <algorithm>

namespace offnominal::bench {

namespace {

constexpr double kNearFloor = 1.2;

void count_score(const Score& score, Summary& summary) {
  summary.first.count(score.first);
  summary.sure.count(score.sure);
  summary.in_class.count(score.in_class);
  summary.all_named.count(score.all_named);
  summary.wrong.count(score.wrong);
}

void count_parameters(const Outcome& outcome, Summary& summary) {
  for (const ParameterCheck& one : outcome.parameters) {
    summary.parameters.count(one.within_tenth);
    if (one.covered) summary.covered.count(*one.covered);
  }
  if (outcome.parameters.empty()) return;
  summary.all_parameters.count(
      std::all_of(outcome.parameters.begin(), outcome.parameters.end(),
                  [](const ParameterCheck& one) { return one.within_tenth; }));
}

void set_times(const std::vector<Outcome>& outcomes, Summary& summary) {
  std::vector<double> times;
  for (const Outcome& one : outcomes) {
    if (one.refused.empty()) times.push_back(one.time_s);
  }
  if (times.empty()) return;
  std::sort(times.begin(), times.end());
  summary.median_s = times[times.size() / 2];
  summary.worst_s = times.back();
}

Summary of_explain(const CaseGroup& group, const std::vector<Outcome>& outcomes) {
  Summary summary;
  summary.group = group.name;
  summary.words = group.words;
  summary.method = "explain";
  summary.kind = group.kind;
  for (const Outcome& one : outcomes) {
    if (!one.refused.empty()) {
      ++summary.refused;
      continue;
    }
    ++summary.cases;
    ++summary.verdicts[one.verdict];
    count_score(one.score, summary);
    count_parameters(one, summary);
    if (!one.named.empty()) summary.holdout.count(one.holdout_ratio <= kNearFloor);
    summary.right_verdict.count(one.right_verdict);
    summary.right_detail.count(one.right_detail);
    const bool undecided = one.verdict == "not_excited" || one.verdict == "ambiguous";
    summary.class_or_undecided.count((one.score.in_class || undecided) && !one.score.wrong);
  }
  set_times(outcomes, summary);
  return summary;
}

Summary of_baseline(const CaseGroup& group, const std::vector<Outcome>& outcomes,
                    const std::string& method, Effects BaselineSelections::*selection) {
  Summary summary;
  summary.group = group.name;
  summary.words = group.words;
  summary.method = method;
  summary.kind = group.kind;
  for (const Outcome& one : outcomes) {
    if (!one.baselines) continue;
    ++summary.cases;
    count_score(score_of(one.truth, (*one.baselines).*selection, {}), summary);
  }
  return summary;
}

}  // namespace

std::vector<Summary> summarise(const CaseGroup& group, const std::vector<Outcome>& outcomes) {
  std::vector<Summary> lines{of_explain(group, outcomes)};
  if (group.with_baselines) {
    lines.push_back(of_baseline(group, outcomes, "stepwise BIC", &BaselineSelections::stepwise));
    lines.push_back(of_baseline(group, outcomes, "STLSQ", &BaselineSelections::thresholded));
  }
  return lines;
}

std::vector<EffectSummary> summarise_effects(const std::vector<Outcome>& outcomes) {
  std::vector<EffectSummary> all;
  for (const Outcome& one : outcomes) {
    if (one.truth.size() != 1) continue;
    const std::string_view name = one.truth[0].name();
    auto place = std::find_if(all.begin(), all.end(),
                              [&](const EffectSummary& summary) { return summary.effect == name; });
    if (place == all.end()) {
      all.emplace_back().effect = name;
      place = all.end() - 1;
    }
    place->first.count(one.score.first);
    place->sure.count(one.score.sure);
    place->in_class.count(one.score.in_class);
    for (const ParameterCheck& check : one.parameters) {
      place->parameters.count(check.within_tenth);
      if (check.covered) place->covered.count(*check.covered);
    }
    if (one.baselines) {
      place->stepwise.count(score_of(one.truth, one.baselines->stepwise, {}).first);
      place->thresholded.count(score_of(one.truth, one.baselines->thresholded, {}).first);
    }
    if (one.score.sure) continue;
    if (one.score.first) {
      ++place->instead["in a class with another"];
    } else if (one.named.empty()) {
      ++place->instead["verdict " + one.verdict];
    } else {
      const bool same_joint = one.named[0].joint == one.truth[0].joint;
      ++place
            ->instead[std::string(one.named[0].name()) + (same_joint ? "" : " on the other joint")];
    }
  }
  return all;
}

}  // namespace offnominal::bench
