#include "robot/read_effect.hpp"

#include <algorithm>
#include <cstddef>

#include "common/nearest.hpp"
#include "robot/friction_sign.hpp"

namespace offnominal::desk {
namespace {

const std::vector<std::string> kCommonKeys{"kind", "joint", "motor", "fitted", "source"};
constexpr double kLongestRail = 1e5;

bool contains(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::vector<std::string> parameter_names(const EffectInfo& info) {
  std::vector<std::string> names;
  for (const ParameterInfo& parameter : info.parameters) names.emplace_back(parameter.name);
  return names;
}

// The table was read with the keys of every kind; now the kind is known.
void refuse_parameters_of_other_kinds(const TomlTable& table, const EffectInfo& info) {
  const std::vector<std::string> own = parameter_names(info);
  for (const std::string& key : effect_keys()) {
    if (!table.has(key) || contains(own, key) || contains(kCommonKeys, key)) continue;
    const std::string meant = nearest(key, own);
    table.refuse(key, "a parameter that " + std::string(info.name) + " does not have", list_of(own),
                 meant.empty() ? "remove it, or change kind" : "write `" + meant + "`");
  }
}

NumberRule rule_of(const EffectInfo& info, const ParameterInfo& parameter, JointType type) {
  NumberRule rule = physical(any_number(unit_of(parameter.quantity, type)));
  // A rail is longer than a link.
  if (rule.unit == "m" && parameter.quantity != Quantity::kLength) rule.largest = kLongestRail;
  if (parameter.min > -effects::kAny) rule.min = parameter.min;
  if (parameter.max < effects::kAny) rule.max = parameter.max;
  rule.mend = std::string("give the ") + parameter.meaning;
  if (takes_energy_out(info.traits, parameter)) {
    rule.min = 0;
    rule.mend +=
        "; below zero it would feed energy in: where a fit gave that, the sign of the torque or of "
        "the velocity is wrong (scale = -1 in [channels]), or another effect is missing";
  }
  return rule;
}

double read_other_joint(const TomlTable& table, const ParameterInfo& parameter,
                        const RobotEffect& effect, std::size_t joint_count) {
  const std::string key = parameter.name;
  const std::string own = std::to_string(effect.joint + 1);
  if (joint_count < 2) {
    table.refuse("kind", "an effect that follows another joint, on a robot of one joint",
                 "a robot of two joints or more", "remove the effect");
  }
  const auto number = table.integer(key, 1, static_cast<std::int64_t>(joint_count));
  if (number == effect.joint + 1) {
    table.refuse(key, own + ", the effect's own joint", "another joint",
                 "give " + std::string(parameter.meaning));
  }
  return static_cast<double>(number);
}

void check_motor(const TomlTable& table, const EffectInfo& info, bool has_transmission) {
  if (table.has("joint")) {
    table.refuse("motor", "a motor beside a joint", "one of the two",
                 "leave out the one on whose shaft it does not act");
  }
  if (!has_transmission) {
    table.refuse("motor", "a motor, without [transmission]",
                 "joint, or motor beside [transmission]",
                 "add [transmission], or write the effect as it is at the joint");
  }
  if (file_motor_may_have(info.kind)) return;
  table.refuse("motor", std::string(info.name) + " of a motor",
               "effects that are a torque of the motor's own motion, its inertia, or elasticity",
               "write `joint`, with the numbers as they are at the joint");
}

}  // namespace

const std::vector<const EffectInfo*>& file_effects() {
  static const std::vector<const EffectInfo*> effects = [] {
    std::vector<const EffectInfo*> all;
    for (const EffectInfo& info : kAllEffectInfos) all.push_back(&info);
    for (const EffectInfo& info : kInfosOutsideChains) all.push_back(&info);
    return all;
  }();
  return effects;
}

const std::vector<std::string>& effect_keys() {
  static const std::vector<std::string> keys = [] {
    std::vector<std::string> all = kCommonKeys;
    for (const EffectInfo* info : file_effects()) {
      for (const std::string& name : parameter_names(*info)) {
        if (!contains(all, name)) all.push_back(name);
      }
    }
    return all;
  }();
  return keys;
}

const std::vector<std::string>& effect_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const EffectInfo* info : file_effects()) all.emplace_back(info->name);
    return all;
  }();
  return names;
}

RobotEffect read_effect(const TomlTable& table, const std::vector<RobotJoint>& joints,
                        bool has_transmission) {
  const EffectInfo& info = *file_effects()[table.choice("kind", effect_names())];
  refuse_parameters_of_other_kinds(table, info);
  RobotEffect effect;
  effect.kind = info.kind;
  effect.of_motor = table.has("motor");
  if (effect.of_motor) check_motor(table, info, has_transmission);
  const auto joint = table.integer(effect.of_motor ? "motor" : "joint", 1,
                                   static_cast<std::int64_t>(joints.size()));
  effect.joint = static_cast<std::uint8_t>(joint - 1);
  effect.fitted = table.boolean("fitted", false);
  effect.source = table.text_or_empty("source");
  const JointType type = effect.of_motor ? JointType::kRevolute : joints[effect.joint].joint.type;
  for (std::size_t i = 0; i < info.parameters.size(); ++i) {
    const ParameterInfo& parameter = info.parameters[i];
    if (parameter.quantity == Quantity::kJointNumber) {
      effect.parameters[i] = read_other_joint(table, parameter, effect, joints.size());
      continue;
    }
    const NumberRule rule = rule_of(info, parameter, type);
    effect.parameters[i] = parameter.required
                               ? table.number(parameter.name, rule)
                               : table.number(parameter.name, rule, parameter.default_value);
  }
  return effect;
}

}  // namespace offnominal::desk
