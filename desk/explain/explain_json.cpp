#include <nlohmann/json.hpp>

#include "compare/compare_report.hpp"
#include "explain/data_fault_report.hpp"
#include "explain/doubts.hpp"
#include "explain/explain_report.hpp"

namespace offnominal::desk {

using nlohmann::ordered_json;

namespace {

ordered_json effect_at(const EffectAt& what) {
  return {{"effect", what.name()}, {"joint", what.joint + 1}};
}

ordered_json parameters_of(const std::vector<Estimate>& numbers) {
  ordered_json parameters = ordered_json::object();
  for (const Estimate& one : numbers) {
    ordered_json value{{"value", one.value.value}, {"unit", one.value.unit}, {"ci95", nullptr}};
    if (one.ci95) {
      value["ci95"] = {(*one.ci95)[0], (*one.ci95)[1]};
    } else {
      value["why_no_ci95"] = one.why_no_interval;
    }
    parameters[one.value.name] = std::move(value);
  }
  return parameters;
}

ordered_json json_of(const Finding& finding) {
  ordered_json json = effect_at(finding.what);
  json["formula"] = finding.formula;
  json["parameters"] = parameters_of(finding.parameters);
  json["p_value"] = finding.p_value;
  json["p_value_replay"] = finding.p_replay;
  json["holdout_error_of_joint"] = finding.seen_on + 1;
  json["holdout_error_before"] = finding.holdout_before;
  json["holdout_error_after"] = finding.holdout_after;
  json["simulated_position_error_before"] = finding.simulated_before;
  json["simulated_position_error_after"] = finding.simulated_after;
  return json;
}

ordered_json json_of(const JointErrors& joint) {
  return {{"joint", joint.joint + 1},
          {"unit", joint.unit},
          {"rms_torque", joint.rms_torque},
          {"rms_error_before", joint.rms_before},
          {"rms_error_after", joint.rms_improved},
          {"rms_error_fitted", joint.rms_after},
          {"holdout_before", joint.holdout_before},
          {"holdout_after", joint.holdout_after},
          {"holdout_fitted", joint.holdout_fitted},
          {"noise_floor", joint.noise_floor},
          {"holdout_noise_floor", joint.holdout_noise_floor}};
}

ordered_json json_of(const Remains& left) {
  ordered_json json{{"rms", left.rms},
                    {"share_of_torque", left.share_of_torque},
                    {"times_noise", left.times_noise},
                    {"follows", nullptr},
                    {"share_of_residual", left.share},
                    {"when", ordered_json::array()}};
  if (!left.follows.empty()) json["follows"] = left.follows;
  for (const LoudSpan& one : left.when) {
    json["when"].push_back(
        {{"recording", one.recording + 1}, {"from_s", one.from_s}, {"to_s", one.to_s}});
  }
  return json;
}

template <typename Item, typename Make>
ordered_json array_of(const std::vector<Item>& items, const Make& make) {
  ordered_json array = ordered_json::array();
  for (const Item& item : items) array.push_back(make(item));
  return array;
}

ordered_json json_of(const JointAnswer& one) {
  return {{"joint", one.joint + 1},
          {"verdict", name_of(one.verdict)},
          {"words", one.words},
          {"found", array_of(one.found, effect_at)},
          {"ambiguous",
           array_of(one.ambiguous, [](const auto& same) { return array_of(same, effect_at); })},
          {"left", json_of(one.left)}};
}

ordered_json json_of(const OverVariable& one) {
  return {{"joint", one.joint + 1},
          {"variable", one.variable},
          {"stand_ins", array_of(one.stand_ins, effect_at)},
          {"share", one.share},
          {"at", one.at},
          {"torque", one.torque}};
}

ordered_json json_of(const Push& one) {
  return {{"file", one.file},
          {"from_s", one.from_s},
          {"to_s", one.to_s},
          {"joints", array_of(one.joints, [](const Push::OnJoint& on) {
             return ordered_json{
                 {"joint", on.joint + 1}, {"rms_torque", on.rms_torque}, {"unit", on.unit}};
           })}};
}

ordered_json json_of(const Change& one) {
  ordered_json json = effect_at(one.what);
  json["alike"] = array_of(one.alike, effect_at);
  json["between"] = one.is_between;
  json["recording"] = one.recording + 1;
  json["at_s"] = nullptr;
  json["at_s_ci95"] = nullptr;
  if (!one.is_between) json["at_s"] = one.at_s;
  if (one.at_ci95_s) json["at_s_ci95"] = *one.at_ci95_s;
  json["until_s"] = nullptr;
  json["until_s_ci95"] = nullptr;
  if (one.until_s) {
    json["until_s"] = *one.until_s;
    json["until_s_ci95"] = one.until_ci95_s;
  }
  json["by"] = parameters_of(one.by);
  json["p_value"] = one.p_value;
  return json;
}

}  // namespace

ordered_json to_json(const Explanation& e, const ExplainNames& names) {
  ordered_json json;
  json["logs"] = names.logs;
  json["after"] = names.after;
  json["holdout"] = names.holdout;
  json["robot"] = names.robot_file;
  json["verdict"] = name_of(e.verdict);
  json["words"] = e.words;
  json["filter"] = e.filter ? to_json(*e.filter) : ordered_json();
  json["noise_floor"] =
      array_of(e.joints, [](const JointErrors& joint) { return ordered_json(joint.noise_floor); });
  json["joints"] = array_of(e.joints, [](const JointErrors& joint) { return json_of(joint); });
  json["answers"] = array_of(e.answers, [](const JointAnswer& one) { return json_of(one); });
  json["over_variable"] =
      array_of(e.over_variable, [](const OverVariable& one) { return json_of(one); });
  json["found"] = array_of(e.found, [](const Finding& finding) { return json_of(finding); });
  json["pushes"] = array_of(e.pushes, [](const Push& one) { return json_of(one); });
  json["changes"] = array_of(e.changes, [](const Change& one) { return json_of(one); });
  json["waterfall"] = ordered_json::array();
  for (std::size_t i = 0; i < e.waterfall.size(); ++i) {
    ordered_json step{{"added", nullptr}, {"holdout", ordered_json::array()}};
    if (i > 0) step["added"] = effect_at(e.found[i - 1].what);
    for (const double error : e.waterfall[i]) step["holdout"].push_back(error);
    json["waterfall"].push_back(std::move(step));
  }
  json["ambiguous"] = array_of(
      e.ambiguous, [](const std::vector<EffectAt>& same) { return array_of(same, effect_at); });
  json["or_own_numbers"] = array_of(
      e.ambiguous, [&](const auto& same) { return ordered_json(may_be_own_numbers(e, same)); });
  json["suspected"] = nullptr;
  if (e.suspected) {
    json["suspected"] = effect_at(e.suspected->what);
    json["suspected"]["p_value"] = e.suspected->p_value;
    json["suspected"]["share_of_squared_error"] = e.suspected->share;
  }
  json["rejected"] = array_of(e.rejected, [](const Rejection& one) {
    ordered_json rejected = effect_at(one.what);
    rejected["p_value"] = one.p_value;
    rejected["smallest_detectable"] = one.smallest_detectable;
    rejected["unit"] = one.unit;
    return rejected;
  });
  json["where"] = array_of(e.where, [](const StructureShare& share) {
    return ordered_json{{"joint", share.joint + 1},
                        {"variable", share.variable},
                        {"share_of_residual", share.share}};
  });
  json["shifts"] = array_of(e.shifts, [](const Shift& shift) {
    return ordered_json{
        {"joint", shift.joint + 1}, {"parameter", shift.name}, {"share_of_file_value", shift.share},
        {"file_value", shift.file}, {"value", shift.came},     {"unit", shift.unit}};
  });
  json["link_share"] = {{"value", e.link_share}, {"judged", e.link_share_judged}};
  json["torque_constants"] = array_of(e.torque_constants, [](const FittedConstant& one) {
    return ordered_json{{"joint", one.joint + 1}, {"error", one.error}};
  });
  json["data_faults"] = to_json(e.data_faults);
  json["data_hints"] = to_json(e.data_hints);
  json["left_out"] = to_json(e.left_out);
  json["excitation"] = array_of(e.excitation, [](const Excitation& one) {
    return ordered_json{{"range", one.range},
                        {"top_speed", one.top_speed},
                        {"separation", one.separation},
                        {"sufficient", one.sufficient}};
  });
  json["hold_friction"] = array_of(e.hold_friction, [](const HoldFriction& one) {
    return ordered_json{{"joint", one.joint + 1}, {"level", one.level}, {"unit", one.unit}};
  });
  json["links_kept_for"] =
      array_of(e.links_kept_for, [](Eigen::Index joint) { return ordered_json(joint + 1); });
  json["advice"] = e.advice;
  json["doubts"] = doubts_of(e);
  return json;
}

}  // namespace offnominal::desk
