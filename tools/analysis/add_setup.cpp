#include "analysis/add_setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "common/error.hpp"
#include "common/nearest.hpp"

namespace offnominal::tools {
namespace {

class SetUp {
 public:
  SetUp(const RobotDescription& robot, const AddRequest& request) : request_(request) {
    setup_.robot = robot;
  }

  AddSetup run() {
    check();
    append_effects();
    apply_given();
    std::vector<Unknown> fresh;
    for (const std::size_t effect : setup_.added) {
      for (const Unknown& unknown : unknowns_of_effect(setup_.robot, effect, true)) {
        if (!is_given(effect, unknown.parameter)) fresh.push_back(unknown);
      }
    }
    if (request_.inertia_deviation) {
      setup_.unknowns = link_scales(setup_.robot, *request_.inertia_deviation);
    }
    if (!request_.keep) refit_coupled(fresh);
    setup_.unknowns.insert(setup_.unknowns.end(), fresh.begin(), fresh.end());
    if (setup_.unknowns.empty()) {
      throw InputError(
          {"--set", "", "every parameter that can be fitted", "at least one left to fit", ""});
    }
    return std::move(setup_);
  }

 private:
  void check() const {
    const RobotDescription& robot = setup_.robot;
    if (request_.joint >= robot.joints.size()) {
      throw InputError(
          {"--joint", "", std::to_string(request_.joint + 1),
           fmt::format("1 to {}, the joints of robot {}", robot.joints.size(), robot.name), ""});
    }
    check_sources();
    std::set<EffectKind> seen;
    for (const EffectKind kind : request_.effects) {
      const EffectInfo& info = *info_of(kind);
      const bool twice = !seen.insert(kind).second;
      const bool there =
          std::any_of(robot.effects.begin(), robot.effects.end(), [&](const RobotEffect& effect) {
            return effect.kind == kind && effect.joint == request_.joint;
          });
      if (!(there || twice) || info.may_repeat()) continue;
      throw InputError(
          {robot.name, fmt::format("joint {}", request_.joint + 1),
           fmt::format("{} {}", info.name, twice ? "asked for twice" : "in the model already"),
           "one of a kind per joint",
           twice ? "" : "mark it `fitted = true` to have it fitted again with the next effect"});
    }
    const std::size_t room = static_cast<std::size_t>(kEffectsPerJoint) * robot.joints.size();
    if (robot.effects.size() + request_.effects.size() > room) {
      throw InputError({robot.name, "effects",
                        std::to_string(robot.effects.size() + request_.effects.size()),
                        fmt::format("up to {}", room), "remove one"});
    }
  }

  // An effect that follows another joint needs one.
  void check_sources() const {
    if (setup_.robot.joints.size() > 1) return;
    for (const EffectKind kind : request_.effects) {
      const EffectInfo& info = *info_of(kind);
      for (const ParameterInfo& parameter : info.parameters) {
        if (parameter.quantity != Quantity::kJointNumber) continue;
        throw InputError({setup_.robot.name, "joints", "one",
                          fmt::format("two or more: {} follows another joint", info.name), ""});
      }
    }
  }

  void append_effects() {
    for (const EffectKind kind : request_.effects) {
      RobotEffect effect;
      effect.kind = kind;
      effect.joint = static_cast<std::uint8_t>(request_.joint);
      effect.fitted = true;
      effect.source = request_.source;
      const auto parameters = info_of(kind)->parameters;
      for (std::size_t i = 0; i < parameters.size(); ++i) {
        if (!parameters[i].required) effect.parameters[i] = parameters[i].default_value;
      }
      setup_.added.push_back(setup_.robot.effects.size());
      setup_.robot.effects.push_back(effect);
    }
  }

  void apply_given() {
    for (const auto& [name, value] : request_.set) {
      std::vector<std::string> known;
      bool used = false;
      for (const std::size_t effect : setup_.added) {
        const EffectInfo& info = *info_of(setup_.robot.effects[effect].kind);
        for (std::size_t i = 0; i < info.parameters.size(); ++i) {
          const std::string own = info.parameters[i].name;
          known.push_back(own);
          if (name != own && name != std::string(info.name) + "." + own) continue;
          check_range(name, value, info.parameters[i]);
          setup_.robot.effects[effect].parameters[i] = value;
          check_source(name, info.parameters[i], setup_.robot.effects[effect]);
          setup_.given.push_back({effect, i});
          used = true;
        }
      }
      if (!used) throw InputError({"--set", "", "\"" + name + "\"", list_of(known), ""});
    }
  }

  void check_source(const std::string& name, const ParameterInfo& info,
                    const RobotEffect& effect) const {
    const auto count = setup_.robot.joint_count();
    if (info.quantity != Quantity::kJointNumber || source_joint_valid(effect, count)) return;
    throw InputError({"--set " + name, "", "no joint beside the effect's own",
                      fmt::format("a whole number from 1 to {}, not {}", count, effect.joint + 1),
                      ""});
  }

  static void check_range(const std::string& name, double value, const ParameterInfo& info) {
    if (value >= info.min && value <= info.max) return;
    std::string allowed =
        info.min <= -effects::kAny ? "a finite number" : fmt::format("{:g} or more", info.min);
    if (info.max < effects::kAny) allowed += fmt::format(", up to {:g}", info.max);
    throw InputError({"--set " + name, "", fmt::format("{:g}", value), allowed, ""});
  }

  bool is_given(std::size_t effect, std::size_t parameter) const {
    return std::any_of(setup_.given.begin(), setup_.given.end(), [&](const ShapeMember& member) {
      return member.effect == effect && member.parameter == parameter;
    });
  }

  // Effects marked fitted that act on a joint whose torque is being fitted, and then those that act
  // on the joints that these act on.
  void refit_coupled(const std::vector<Unknown>& fresh) {
    std::set<std::size_t> joints;
    const auto touch = [&](const Unknown& unknown) {
      for (const std::size_t joint : joints_of(setup_.robot, unknown)) joints.insert(joint);
    };
    for (const Unknown& unknown : fresh) touch(unknown);
    for (const Unknown& unknown : setup_.unknowns) touch(unknown);
    std::set<std::size_t> chosen;
    for (bool grew = true; grew;) {
      grew = false;
      for (std::size_t effect = 0; effect < setup_.added.front(); ++effect) {
        if (!setup_.robot.effects[effect].fitted || chosen.contains(effect)) continue;
        const auto unknowns = unknowns_of_effect(setup_.robot, effect, false);
        const auto of_effect = joints_of(setup_.robot, unknowns.front());
        if (std::none_of(of_effect.begin(), of_effect.end(),
                         [&](std::size_t joint) { return joints.contains(joint); })) {
          continue;
        }
        chosen.insert(effect);
        for (const Unknown& unknown : unknowns) touch(unknown);
        grew = true;
      }
    }
    for (const std::size_t effect : chosen) {
      const auto unknowns = unknowns_of_effect(setup_.robot, effect, false);
      setup_.unknowns.insert(setup_.unknowns.end(), unknowns.begin(), unknowns.end());
      setup_.refitted.push_back(effect);
    }
  }

  const AddRequest& request_;
  AddSetup setup_;
};

}  // namespace

AddSetup set_up(const RobotDescription& robot, const AddRequest& request) {
  return SetUp(robot, request).run();
}

}  // namespace offnominal::tools
