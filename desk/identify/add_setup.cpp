#include "identify/add_setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "common/error.hpp"
#include "common/nearest.hpp"
#include "identify/effects/effects.hpp"
#include "identify/sign_width.hpp"
#include "robot/read_effect.hpp"

namespace offnominal::desk {
namespace {

// "1 is shoulder, 2 is elbow"
std::string joints_in_words(const RobotDescription& robot) {
  std::vector<std::string> words;
  for (const RobotJoint& joint : robot.joints) {
    words.push_back(fmt::format("{} is {}", words.size() + 1, joint.name));
  }
  return "count from the base outwards: " + list_of(words);
}

class SetUp {
 public:
  SetUp(const RobotDescription& robot, const AddRequest& request)
      : robot_(robot), request_(request) {}

  AddSetup run() {
    check();
    take_effects();
    apply_given();
    if (!request_.keep) refit_coupled();
    if (setup_.refitted.empty() && !request_.inertia_deviation && !leaves_something_to_fit()) {
      throw InputError(
          {"--set", "", "every parameter that can be fitted", "at least one left to fit", ""});
    }
    return std::move(setup_);
  }

 private:
  void check() const {
    const RobotDescription& robot = robot_;
    if (request_.joint >= robot.joints.size()) {
      throw InputError({request_.of_motor ? "--motor" : "--joint", "",
                        std::to_string(request_.joint + 1),
                        fmt::format("1 to {}, the {} of robot {}", robot.joints.size(),
                                    request_.of_motor ? "motors" : "joints", robot.name),
                        request_.of_motor ? "count the motors as the lists of [channels] have them"
                                          : joints_in_words(robot)});
    }
    if (request_.of_motor) check_motor();
    check_sources();
    std::set<EffectKind> seen;
    for (const EffectKind kind : request_.effects) {
      const EffectInfo& info = *info_of(kind);
      const bool twice = !seen.insert(kind).second;
      const bool there =
          std::any_of(robot.effects.begin(), robot.effects.end(), [&](const RobotEffect& effect) {
            return effect.kind == kind && effect.joint == request_.joint &&
                   effect.of_motor == request_.of_motor;
          });
      if (!(there || twice) || info.may_repeat()) continue;
      throw InputError(
          {robot.name,
           fmt::format("{} {}", request_.of_motor ? "motor" : "joint", request_.joint + 1),
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

  void check_motor() const {
    if (!robot_.transmission) {
      throw InputError({"--motor", "", "a motor", "--joint: the robot file has no [transmission]",
                        "add [transmission] to the robot file"});
    }
    for (const EffectKind kind : request_.effects) {
      if (motor_may_be_searched(kind)) continue;
      std::vector<std::string> allowed;
      for (const EffectInfo* info : file_effects()) {
        if (motor_may_be_searched(info->kind)) allowed.emplace_back(info->name);
      }
      throw InputError({"--motor", "", info_of(kind)->name, list_of(allowed),
                        "say --joint: at the joint it is fitted as well"});
    }
  }

  // An effect that follows another joint needs one.
  void check_sources() const {
    if (robot_.joints.size() > 1) return;
    for (const EffectKind kind : request_.effects) {
      const EffectInfo& info = *info_of(kind);
      for (const ParameterInfo& parameter : info.parameters) {
        if (parameter.quantity != Quantity::kJointNumber) continue;
        throw InputError({robot_.name, "joints", "one",
                          fmt::format("two or more: {} follows another joint", info.name), ""});
      }
    }
  }

  void take_effects() {
    for (const EffectKind kind : request_.effects) {
      AddSetup::NewEffect one{candidate_of(kind), {}};
      one.given.resize(one.effect->info().parameters.size());
      act_on_motor(*one.effect);
      setup_.added.push_back(std::move(one));
    }
  }

  void act_on_motor(EffectCandidate& effect) const {
    if (request_.of_motor) effect.act_on_motor(joints_of_motor(robot_, request_.joint));
  }

  void apply_given() {
    for (const auto& [name, value] : request_.set) {
      std::vector<std::string> known;
      bool used = false;
      for (AddSetup::NewEffect& one : setup_.added) {
        const EffectInfo& info = one.effect->info();
        for (std::size_t i = 0; i < info.parameters.size(); ++i) {
          const std::string own = info.parameters[i].name;
          known.push_back(own);
          if (name != own && name != std::string(info.name) + "." + own) continue;
          check_range(name, value, info.parameters[i]);
          check_source(name, value, info.parameters[i]);
          one.given[i] = value;
          used = true;
        }
      }
      if (!used) throw InputError({"--set", "", "\"" + name + "\"", list_of(known), ""});
    }
    for (AddSetup::NewEffect& one : setup_.added) give(one);
  }

  // What the search looks for in its own way is, where it is given, the struct's own.
  static void give(AddSetup::NewEffect& one) {
    const EffectKind kind = one.effect->kind();
    for (std::size_t i = 0; i < one.given.size(); ++i) {
      if (!one.given[i]) continue;
      if (one.effect->shape_is_coefficient(i)) one.effect = std::make_unique<EffectCandidate>(kind);
    }
    for (std::size_t i = 0; i < one.given.size(); ++i) {
      if (one.given[i]) one.effect->give(i, *one.given[i]);
    }
  }

  bool leaves_something_to_fit() const {
    return std::any_of(setup_.added.begin(), setup_.added.end(), [](const auto& one) {
      const auto parameters = one.effect->info().parameters;
      const auto is_linear = [](const ParameterInfo& parameter) {
        return parameter.role == ParameterRole::kLinear;
      };
      const bool only_shapes = std::none_of(parameters.begin(), parameters.end(), is_linear);
      for (std::size_t i = 0; i < parameters.size(); ++i) {
        if ((only_shapes || is_linear(parameters[i])) && !one.given[i]) return true;
      }
      return false;
    });
  }

  void check_source(const std::string& name, double value, const ParameterInfo& info) const {
    if (info.quantity != Quantity::kJointNumber) return;
    const auto count = static_cast<double>(robot_.joint_count());
    const bool is_another = value >= 1 && value <= count && value == std::floor(value) &&
                            value != static_cast<double>(request_.joint + 1);
    if (is_another) return;
    throw InputError(
        {"--set " + name, "", "no joint beside the effect's own",
         fmt::format("a whole number from 1 to {:g}, not {}", count, request_.joint + 1), ""});
  }

  static void check_range(const std::string& name, double value, const ParameterInfo& info) {
    if (value >= info.min && value <= info.max) return;
    std::string allowed =
        info.min <= -effects::kAny ? "a finite number" : fmt::format("{:g} or more", info.min);
    if (info.max < effects::kAny) allowed += fmt::format(", up to {:g}", info.max);
    throw InputError({"--set " + name, "", fmt::format("{:g}", value), allowed, ""});
  }

  // Effects marked fitted that act on a joint whose torque is being fitted, and then those that act
  // on the joints that these act on.
  void refit_coupled() {
    std::set<std::size_t> joints;
    for (const EffectKind kind : request_.effects) {
      const auto own = joints_of(robot_, kind, request_.joint, request_.of_motor);
      joints.insert(own.begin(), own.end());
    }
    for (std::size_t j = 0; request_.inertia_deviation && j < robot_.joints.size(); ++j) {
      joints.insert(j);
    }
    std::set<std::size_t> chosen;
    for (bool grew = true; grew;) {
      grew = false;
      for (std::size_t effect = 0; effect < robot_.effects.size(); ++effect) {
        const RobotEffect& one = robot_.effects[effect];
        if (!one.fitted || chosen.contains(effect)) continue;
        const auto of_effect = joints_of(robot_, one.kind, one.joint, one.of_motor);
        if (std::none_of(of_effect.begin(), of_effect.end(),
                         [&](std::size_t joint) { return joints.contains(joint); })) {
          continue;
        }
        chosen.insert(effect);
        joints.insert(of_effect.begin(), of_effect.end());
        grew = true;
      }
    }
    setup_.refitted.assign(chosen.begin(), chosen.end());
  }

  const RobotDescription& robot_;
  const AddRequest& request_;
  AddSetup setup_;
};

}  // namespace

AddSetup set_up(const RobotDescription& robot, const AddRequest& request) {
  return SetUp(robot, request).run();
}

std::size_t parameter_of_coefficient(const EffectCandidate& effect, std::size_t coefficient) {
  const auto parameters = effect.info().parameters;
  std::size_t linear = 0;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const bool is_coefficient =
        parameters[i].role == ParameterRole::kLinear || effect.shape_is_coefficient(i);
    if (is_coefficient && linear++ == coefficient) return i;
  }
  return 0;
}

std::vector<Term> terms_of(const AddSetup& setup, std::size_t joint, const Data& data) {
  std::vector<Term> terms;
  const auto index = static_cast<Eigen::Index>(joint);
  for (const AddSetup::NewEffect& one : setup.added) {
    const EffectCandidate& effect = *one.effect;
    const auto parameters = effect.info().parameters;
    Term term{&effect, index, {}, effect.shapes(data.recordings, index), {}};
    for (ShapeRange& range : term.ranges) {
      for (std::size_t i = 0; i < parameters.size(); ++i) {
        if (range.name != parameters[i].name) continue;
        // A joint that does not move has no grid, and any value does.
        if (range.grid.empty()) range.grid = {std::max(parameters[i].min, 1.0)};
        if (!one.given[i]) continue;
        range.grid = {*one.given[i]};
        range.kind = ShapeRange::Kind::kDiscrete;
      }
    }
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const bool is_coefficient =
          parameters[i].role == ParameterRole::kLinear || effect.shape_is_coefficient(i);
      if (is_coefficient) term.given.push_back(one.given[i]);
    }
    terms.push_back(std::move(term));
  }
  return terms;
}

Eigen::VectorXd given_widths(const AddSetup& setup, std::size_t joint, int joint_count) {
  Eigen::VectorXd widths = Eigen::VectorXd::Zero(joint_count);
  for (const AddSetup::NewEffect& one : setup.added) {
    const std::size_t width = width_of(one.effect->kind());
    if (one.effect->of_motor() || width >= one.given.size() || !one.given[width]) continue;
    auto followed = static_cast<Eigen::Index>(joint);
    const auto parameters = one.effect->info().parameters;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      if (parameters[i].quantity != Quantity::kJointNumber) continue;
      // Of two joints it is the other one.
      followed = one.given[i]       ? static_cast<Eigen::Index>(*one.given[i]) - 1
                 : joint_count == 2 ? 1 - followed
                                    : -1;
    }
    if (followed >= 0) widths[followed] = *one.given[width];
    for (Eigen::Index j = 0; followed < 0 && j < joint_count; ++j) {
      if (j != static_cast<Eigen::Index>(joint)) widths[j] = *one.given[width];
    }
  }
  return widths;
}

}  // namespace offnominal::desk
