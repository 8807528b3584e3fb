#include <nlohmann/json.hpp>

#include "tables.hpp"

namespace offnominal::bench {

using nlohmann::ordered_json;

namespace {

ordered_json json_of(const Rate& rate) { return {{"hits", rate.hits}, {"of", rate.of}}; }

ordered_json json_of(const Effects& effects) {
  ordered_json list = ordered_json::array();
  for (const auto& one : effects) list.push_back(text_of(one));
  return list;
}

ordered_json parameters_of(const Outcome& outcome) {
  ordered_json list = ordered_json::array();
  for (const ParameterCheck& one : outcome.parameters) {
    ordered_json check{{"name", one.name},
                       {"truth", one.truth},
                       {"estimate", one.estimate},
                       {"within_tenth", one.within_tenth},
                       {"covered", nullptr}};
    if (one.covered) check["covered"] = *one.covered;
    list.push_back(std::move(check));
  }
  return list;
}

}  // namespace

ordered_json json_of(const Summary& line) {
  return {{"cases", line.group},
          {"method", line.method},
          {"n", line.cases},
          {"refused", line.refused},
          {"first", json_of(line.first)},
          {"first_and_alone", json_of(line.sure)},
          {"in_class", json_of(line.in_class)},
          {"all_named", json_of(line.all_named)},
          {"wrong", json_of(line.wrong)},
          {"parameters_within_tenth", json_of(line.parameters)},
          {"all_parameters_within_tenth", json_of(line.all_parameters)},
          {"intervals_cover", json_of(line.covered)},
          {"holdout_near_floor", json_of(line.holdout)},
          {"right_verdict", json_of(line.right_verdict)},
          {"right_detail", json_of(line.right_detail)},
          {"verdicts", line.verdicts},
          {"median_s", line.median_s},
          {"worst_s", line.worst_s}};
}

ordered_json json_of(const CaseGroup& group, const Outcome& outcome) {
  ordered_json one{{"cases", group.name},
                   {"seed", outcome.request.seed},
                   {"hidden", outcome.hidden},
                   {"verdict", outcome.verdict},
                   {"named", json_of(outcome.named)}};
  if (!outcome.before.empty()) one["before"] = outcome.before;
  ordered_json classes = ordered_json::array();
  for (const Effects& same : outcome.classes) classes.push_back(json_of(same));
  one["classes"] = std::move(classes);
  one["suspected"] = json_of(outcome.suspected);
  one["wrong"] = outcome.score.wrong;
  one["right_verdict"] = outcome.right_verdict;
  one["right_detail"] = outcome.right_detail;
  one["parameters"] = parameters_of(outcome);
  one["holdout_ratio"] = outcome.holdout_ratio;
  one["time_s"] = outcome.time_s;
  if (!outcome.refused.empty()) one["refused"] = outcome.refused;
  if (!outcome.failed.empty()) one["failed"] = outcome.failed;
  if (outcome.baselines) {
    one["stepwise"] = json_of(outcome.baselines->stepwise);
    one["thresholded"] = json_of(outcome.baselines->thresholded);
  }
  return one;
}

}  // namespace offnominal::bench
