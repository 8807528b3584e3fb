#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "arm_outcome.hpp"

namespace offnominal::bench {

using desk::EffectAt;
using nlohmann::ordered_json;

std::string name_at(const EffectAt& one) { return fmt::format("{}@{}", one.name(), one.joint + 1); }

namespace {

ordered_json names_at(const std::vector<EffectAt>& effects) {
  ordered_json list = ordered_json::array();
  for (const EffectAt& one : effects) list.push_back(name_at(one));
  return list;
}

ordered_json json_of(const ArmTrueEffect& one) {
  const EffectAt what{one.effect.kind, one.effect.joint};
  ordered_json json{{"effect", what.name()}, {"joint", what.joint + 1}};
  for (const auto& number : one.effect.numbers) json["parameters"][number.first] = number.second;
  json["rms_nm"] = one.rms_nm;
  json["share_of_torque"] = one.share;
  json["asked_for"] = one.is_asked_for;
  if (one.effect.from_s > 0) json["from_s"] = one.effect.from_s;
  return json;
}

ordered_json json_of(const ArmPush& push) {
  return {{"link", push.link + 1},
          {"from_s", push.from_s},
          {"to_s", push.to_s},
          {"force_n", {push.force_n.x(), push.force_n.y(), push.force_n.z()}}};
}

ordered_json maybe(const std::optional<bool>& value) {
  return value ? ordered_json(*value) : ordered_json(nullptr);
}

ordered_json json_of(const ArmAsked& one) {
  return {{"effect", name_at(one.what)},
          {"share_of_torque", one.share},
          {"named", one.named},
          {"class_size", one.class_size},
          {"instead", one.instead}};
}

template <typename Item>
ordered_json list_of(const std::vector<Item>& items) {
  ordered_json list = ordered_json::array();
  for (const Item& item : items) list.push_back(json_of(item));
  return list;
}

}  // namespace

ordered_json json_of(const ArmTruth& truth) {
  return {{"effects", list_of(truth.effects)},
          {"changes", list_of(truth.changes)},
          {"pushes", list_of(truth.pushes)},
          {"cad_error", truth.cad_error},
          {"friction_error", truth.friction_error},
          {"link_mass_error_share", truth.link_mass_error_share},
          {"torque_constant_error", truth.torque_constant_error},
          {"torque_noise_nm", truth.noise_nm},
          {"stands", truth.stands},
          {"rate_hz", truth.rate_hz},
          {"duration_s", truth.duration_s},
          {"positions", truth.positions},
          {"motion", truth.motion}};
}

ordered_json json_of(const ArmGroup& group, const ArmOutcome& outcome) {
  ordered_json json{{"group", group.name},
                    {"seed", outcome.request.seed},
                    {"refused", outcome.refused},
                    {"failed", outcome.failed}};
  if (!outcome.refused.empty()) return json;
  json["truth"] = json_of(outcome.truth);
  json["verdict"] = outcome.verdict;
  json["named"] = names_at(outcome.named);
  json["classes"] = ordered_json::array();
  for (const auto& same : outcome.classes) json["classes"].push_back(names_at(same));
  json["asked"] = list_of(outcome.score.asked);
  json["wrong"] = names_at(outcome.score.wrong);
  json["false_pushes"] = outcome.score.false_pushes;
  json["payload_within_tenth"] = maybe(outcome.score.payload);
  json["moment_within_tenth_s"] = maybe(outcome.score.moment);
  json["time_s"] = outcome.time_s;
  return json;
}

std::string text_of(const ArmTruth& truth) {
  std::string text;
  const auto add = [&](const std::string& one) { text += (text.empty() ? "" : ", ") + one; };
  for (const auto* effects : {&truth.effects, &truth.changes}) {
    for (const ArmTrueEffect& one : *effects) {
      add(fmt::format("{} {:.1f} %{}{}", name_at({one.effect.kind, one.effect.joint}),
                      100 * one.share,
                      one.effect.from_s > 0 ? fmt::format(" from {:.3f} s", one.effect.from_s) : "",
                      one.is_asked_for || one.effect.from_s > 0 ? "" : " (too small)"));
    }
  }
  for (const ArmPush& push : truth.pushes) {
    add(fmt::format("push on link {} from {:.2f} to {:.2f} s", push.link + 1, push.from_s,
                    push.to_s));
  }
  return text.empty() ? "nothing" : text;
}

}  // namespace offnominal::bench
