#include "studio/cards.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace offnominal::desk::studio {

using nlohmann::ordered_json;

namespace {

ordered_json json_of(const EffectAt& what) {
  return {{"effect", what.name()},
          {"joint", what.joint + 1},
          {"words", info_of(what.kind)->words},
          {"motion", info_of(what.kind)->motion_hint}};
}

ordered_json json_of(const Estimate& one) {
  ordered_json json{{"name", one.value.name},
                    {"value", one.value.value},
                    {"unit", one.value.unit},
                    {"ci95", nullptr},
                    {"why_no_ci95", one.why_no_interval}};
  if (one.ci95) json["ci95"] = {(*one.ci95)[0], (*one.ci95)[1]};
  return json;
}

// What the recordings do not tell from it.
ordered_json alternatives_to(const EffectAt& what, const Explanation& explanation) {
  ordered_json others = ordered_json::array();
  for (const std::vector<EffectAt>& same : explanation.ambiguous) {
    if (!holds(same, what)) continue;
    for (const EffectAt& other : same) {
      if (!(other == what)) others.push_back(json_of(other));
    }
  }
  return others;
}

ordered_json card_of(const Finding& finding, const Explanation& explanation) {
  ordered_json card = json_of(finding.what);
  card["title"] = title_of(finding);
  card["formula"] = finding.formula;
  card["parameters"] = ordered_json::array();
  for (const Estimate& one : finding.parameters) card["parameters"].push_back(json_of(one));
  card["p_value"] = finding.p_value;
  card["takes_of_held_out"] = finding.takes_of_held_out();
  card["seen_on"] = finding.seen_on + 1;
  card["unit"] = "";
  for (const JointErrors& errors : explanation.joints) {
    if (errors.joint == finding.what.joint) card["unit"] = errors.unit;
  }
  card["alternatives"] = alternatives_to(finding.what, explanation);
  const auto number = static_cast<std::size_t>(&finding - explanation.found.data());
  card["finding"] = nullptr;
  if (improved_effect(explanation, number)) card["finding"] = number;
  return card;
}

ordered_json joint_of(const JointAnswer& answer, const Explanation& explanation) {
  ordered_json json{{"joint", answer.joint + 1},
                    {"verdict", name_of(answer.verdict)},
                    {"words", answer.words},
                    {"cards", ordered_json::array()},
                    {"classes", ordered_json::array()}};
  for (const Finding& finding : explanation.found) {
    if (finding.what.joint == answer.joint) json["cards"].push_back(card_of(finding, explanation));
  }
  for (const std::vector<EffectAt>& same : answer.ambiguous) {
    ordered_json members = ordered_json::array();
    for (const EffectAt& one : same) members.push_back(json_of(one));
    json["classes"].push_back({{"effects", std::move(members)},
                               {"or_own_numbers", may_be_own_numbers(explanation, same)}});
  }
  return json;
}

// Of several effects of one kind on a joint, how far the numbers of one are from a finding's.
double distance(const RobotEffect& effect, const Finding& finding) {
  double sum = 0;
  const auto parameters = info_of(effect.kind)->parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    for (const Estimate& one : finding.parameters) {
      if (one.value.name != parameters[i].name) continue;
      sum += std::abs(one.value.value - effect.parameters[i]) / (1e-12 + std::abs(one.value.value));
    }
  }
  return sum;
}

const char* word_of(Job::State state) {
  switch (state) {
    case Job::State::kNone:
      return "none";
    case Job::State::kRunning:
      return "running";
    case Job::State::kDone:
      return "done";
    case Job::State::kStopped:
      return "stopped";
    case Job::State::kFailed:
      break;
  }
  return "failed";
}

}  // namespace

ordered_json cards_of(const Explanation& explanation) {
  ordered_json json{{"verdict", name_of(explanation.verdict)},
                    {"words", explanation.words},
                    {"joints", ordered_json::array()},
                    {"advice", explanation.advice}};
  for (const JointAnswer& answer : explanation.answers) {
    json["joints"].push_back(joint_of(answer, explanation));
  }
  return json;
}

std::optional<std::size_t> improved_effect(const Explanation& explanation, std::size_t finding) {
  if (finding >= explanation.found.size()) return std::nullopt;
  const Finding& found = explanation.found[finding];
  if (!is_written(explanation, found.what)) return std::nullopt;
  std::optional<std::size_t> best;
  double least = std::numeric_limits<double>::infinity();
  const std::vector<RobotEffect>& effects = explanation.improved.effects;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const bool is_same = effects[i].kind == found.what.kind && !effects[i].of_motor &&
                         effects[i].joint == static_cast<std::size_t>(found.what.joint);
    if (!is_same || !(distance(effects[i], found) < least)) continue;
    least = distance(effects[i], found);
    best = i;
  }
  return best;
}

void without_pictures(ordered_json& answer) {
  if (!answer.at("answer").is_object()) return;
  for (ordered_json& joint : answer.at("answer").at("joints")) {
    for (ordered_json& card : joint.at("cards")) card["finding"] = nullptr;
  }
}

ordered_json to_json(const Job::Report& report) {
  ordered_json json{{"state", word_of(report.state)}, {"doing", report.doing},
                    {"seconds", report.seconds},      {"error", report.error},
                    {"revision", report.of_revision}, {"answer", nullptr}};
  if (report.explanation) json["answer"] = cards_of(*report.explanation);
  return json;
}

}  // namespace offnominal::desk::studio
