#include "identify/add_doubts.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/nearest.hpp"
#include "robot/effect_text.hpp"

namespace offnominal::desk {
namespace {

std::string names_of(const RobotDescription& robot, const std::vector<Unknown>& unknowns) {
  std::vector<std::string> names;
  for (const Unknown& unknown : unknowns) names.push_back(name_of(robot, unknown));
  return list_of(names);
}

double start_of(const AddResult& result, const Unknown& unknown) {
  if (unknown.kind == Unknown::Kind::kLinkScale) return 1;
  return result.robot.effects[unknown.effect].parameters[unknown.parameter];
}

bool is_one_of(const std::vector<std::size_t>& joints, const BeforeAfter& error) {
  return std::find(joints.begin(), joints.end(), error.joint) != joints.end();
}

// Whether one of the joints gains more than that share, on data that the fit has not seen.
bool falls_by_more_than(double share, const std::vector<std::size_t>& joints,
                        const AddResult& result) {
  return std::any_of(result.held_out.begin(), result.held_out.end(), [&](const auto& error) {
    return is_one_of(joints, error) && error.fall() > share;
  });
}

}  // namespace

std::string name_of(const AddResult& result, const FittedParameter& parameter) {
  const RobotEffect& effect = result.robot.effects[parameter.effect];
  const EffectInfo& info = *info_of(effect.kind);
  return fmt::format("{}.{} of {}", info.name, info.parameters[parameter.parameter].name,
                     place_of(effect));
}

std::string value_words(const AddResult& result, const FittedParameter& parameter) {
  const RobotEffect& effect = result.robot.effects[parameter.effect];
  const ParameterInfo& info = info_of(effect.kind)->parameters[parameter.parameter];
  const std::string unit = unit_of(info.quantity, result.robot.type_of(effect));
  std::string words =
      fmt::format("{:.6g}{}{}", parameter.value, unit == "1" ? "" : " ", unit == "1" ? "" : unit);
  if (parameter.ci95) {
    words +=
        fmt::format(", 95 % between {:.6g} and {:.6g}", (*parameter.ci95)[0], (*parameter.ci95)[1]);
  }
  return words;
}

void note_indistinct(AddResult& result) {
  for (const Indistinct& indistinct : result.fit.indistinct) {
    const std::string name = name_of(result.robot, indistinct.fixed);
    const std::string value = fmt::format("{:.6g}", start_of(result, indistinct.fixed));
    if (indistinct.others.empty()) {
      result.notes.push_back(fmt::format(
          "{} has no influence on the torque in this recording: left at {}", name, value));
    } else {
      result.notes.push_back(fmt::format(
          "this recording cannot tell {} from {}: {} was left at {}, what they share is in the "
          "other",
          name, names_of(result.robot, indistinct.others), name, value));
    }
  }
}

void object_to_indistinct(const std::vector<Unknown>& unknowns, AddResult& result) {
  for (const std::size_t effect : result.added) {
    std::size_t asked = 0;
    std::vector<Unknown> others;
    std::size_t lost = 0;
    for (const Unknown& unknown : unknowns) asked += unknown.is_new && unknown.effect == effect;
    for (const Indistinct& indistinct : result.fit.indistinct) {
      if (!indistinct.fixed.is_new || indistinct.fixed.effect != effect) continue;
      ++lost;
      others.insert(others.end(), indistinct.others.begin(), indistinct.others.end());
    }
    if (asked == 0 || lost < asked) continue;
    const std::string name = info_of(result.robot.effects[effect].kind)->name;
    result.objections.push_back(
        others.empty() ? fmt::format("{} has no influence on the torque in this recording", name)
                       : fmt::format("this recording cannot tell {} from {}", name,
                                     names_of(result.robot, others)));
  }
}

void doubt_what_held_out_data_say(const AddRequest& request, AddResult& result) {
  const std::vector<std::size_t> joints = joints_asked(result.robot, request);
  constexpr double kBeyondChance = 0.01;
  const bool falls = falls_by_more_than(joints.size() > 1 ? kBeyondChance : 0, joints, result);
  const BeforeAfter* most = nullptr;
  for (const BeforeAfter& error : result.held_out) {
    if (!is_one_of(joints, error)) continue;
    if (most == nullptr || error.fall() > most->fall()) most = &error;
  }
  for (const BeforeAfter& error : result.held_out) {
    const bool asked = &error == most && !falls;
    if (!asked && !error.rises()) continue;
    result.doubts.push_back(
        fmt::format("on data not used for the fit the error of joint {} {}, from {:.2f} % to "
                    "{:.2f} %: these data do not support the effect",
                    error.joint + 1, asked ? "does not fall" : "rises", error.before_percent,
                    error.after_percent));
  }
}

void doubt_what_may_be_nothing(const AddRequest& request, AddResult& result) {
  constexpr double kClearly = 0.1;
  if (falls_by_more_than(kClearly, joints_asked(result.robot, request), result)) return;
  for (const std::size_t effect : result.added) {
    const EffectInfo& info = *info_of(result.robot.effects[effect].kind);
    const auto is_strength = [](const ParameterInfo& parameter) {
      return parameter.role == ParameterRole::kLinear;
    };
    const bool has_strength =
        std::any_of(info.parameters.begin(), info.parameters.end(), is_strength);
    std::vector<std::string> words;
    bool nothing = true;
    for (const FittedParameter& parameter : result.fit.parameters) {
      if (parameter.effect != effect || !parameter.fitted) continue;
      if (has_strength && !is_strength(info.parameters[parameter.parameter])) continue;
      nothing = nothing && parameter.ci95 && (*parameter.ci95)[0] <= 0 && (*parameter.ci95)[1] >= 0;
      words.push_back(name_of(result, parameter) + ": " + value_words(result, parameter));
    }
    if (words.empty() || !nothing) continue;
    result.doubts.push_back(fmt::format(
        "{}: 0 fits as well, these recordings do not show the effect", fmt::join(words, ", ")));
  }
}

}  // namespace offnominal::desk
