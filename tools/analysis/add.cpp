#include "analysis/add.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "analysis/add_setup.hpp"
#include "analysis/friction_power.hpp"
#include "analysis/lookalike.hpp"
#include "analysis/physical_range.hpp"
#include "common/nearest.hpp"

namespace offnominal::tools {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// The held-out parts of the fitted recording: the old model on the same samples.
std::vector<BeforeAfter> both_held_out(const Comparison& before, const Fit& fit,
                                       const std::vector<int>& parts) {
  std::vector<BeforeAfter> result;
  for (const HeldOutError& held_out : fit.held_out) {
    const auto joint = static_cast<Index>(held_out.joint);
    double old_error = 0;
    double torque = 0;
    double count = 0;
    for (Index i = 0; i < before.measured.rows(); ++i) {
      if (parts[static_cast<std::size_t>(i)] < 0) continue;
      const double error = before.measured(i, joint) - before.model(i, joint);
      old_error += error * error;
      torque += before.measured(i, joint) * before.measured(i, joint);
      count += 1;
    }
    const double new_error = held_out.squared_error;
    result.push_back({held_out.joint, before.joints[held_out.joint].unit,
                      100 * std::sqrt(old_error / torque), 100 * std::sqrt(new_error / torque),
                      std::sqrt(old_error / count), std::sqrt(new_error / count)});
  }
  return result;
}

std::string names_of(const RobotDescription& robot, const std::vector<Unknown>& unknowns) {
  std::vector<std::string> names;
  for (const Unknown& unknown : unknowns) names.push_back(name_of(robot, unknown));
  return list_of(names);
}

void note_indistinct(AddResult& result) {
  for (const Indistinct& indistinct : result.fit.indistinct) {
    const std::string name = name_of(result.robot, indistinct.fixed);
    const std::string value = fmt::format("{:.6g}", indistinct.fixed.start);
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

void note_lookalikes(const FitProblem& problem, AddResult& result) {
  for (const Lookalike& lookalike : lookalikes(problem, result.fit)) {
    result.notes.push_back(
        fmt::format("{} looks the same in this recording as {}.{}, which the model does not have",
                    name_of(result.robot, lookalike.fitted), info_of(lookalike.effect)->name,
                    lookalike.parameter));
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

std::string name_of(const AddResult& result, const FittedParameter& parameter) {
  const RobotEffect& effect = result.robot.effects[parameter.effect];
  const EffectInfo& info = *info_of(effect.kind);
  return fmt::format("{}.{} of joint {}", info.name, info.parameters[parameter.parameter].name,
                     effect.joint + 1);
}

// "-10 N m s/rad, 95 % between -10.2 and -9.8"
std::string value_words(const AddResult& result, const FittedParameter& parameter) {
  const RobotEffect& effect = result.robot.effects[parameter.effect];
  const ParameterInfo& info = info_of(effect.kind)->parameters[parameter.parameter];
  const std::string unit = unit_of(info.quantity, result.robot.joints[effect.joint].joint.type);
  std::string words =
      fmt::format("{:.6g}{}{}", parameter.value, unit == "1" ? "" : " ", unit == "1" ? "" : unit);
  if (parameter.ci95) {
    words +=
        fmt::format(", 95 % between {:.6g} and {:.6g}", (*parameter.ci95)[0], (*parameter.ci95)[1]);
  }
  return words;
}

// A fitted number that physics does not let be what fits best.
struct Beyond {
  FittedParameter parameter;
  PhysicalRange range;
  bool contradicted = false;  // by the recording; else the end of the range fits as well
};

// Share of the joint's rms torque that a number's change by `by` makes.
double torque_share(const FitProblem& problem, const std::vector<JointRows>& rows,
                    const FittedParameter& parameter, double by) {
  for (std::size_t i = 0; i < problem.unknowns().size(); ++i) {
    const Unknown& unknown = problem.unknowns()[i];
    if (unknown.kind != Unknown::Kind::kEffectParameter || unknown.effect != parameter.effect ||
        unknown.parameter != parameter.parameter) {
      continue;
    }
    for (const JointRows& joint : rows) {
      if (joint.joint != unknown.joint) continue;
      const auto column = joint.columns.col(static_cast<Index>(i));
      const auto torque = problem.measured().torque.col(static_cast<Index>(joint.joint));
      return std::abs(by) * column.norm() / torque.norm();
    }
  }
  return 0;
}

std::vector<Beyond> beyond_their_ranges(const FitProblem& problem, const AddResult& result) {
  std::vector<Beyond> all;
  for (const FittedParameter& parameter : result.fit.parameters) {
    const EffectKind kind = result.robot.effects[parameter.effect].kind;
    const PhysicalRange range = physical_range(kind, parameter.parameter);
    if (range.holds(parameter.value)) continue;
    const double share = torque_share(problem, problem.rows(problem.shapes_in(result.robot)),
                                      parameter, parameter.value - range.nearest(parameter.value));
    all.push_back({parameter, range, contradicts(range, parameter.ci95, share)});
  }
  return all;
}

void object_to_ranges(const FitProblem& problem, AddResult& result) {
  for (const auto& [parameter, range, contradicted] : beyond_their_ranges(problem, result)) {
    const std::string cause =
        contradicted ? std::string(range.usual_cause())
                     : fmt::format(
                           "{:g}, the end of that, fits as well: the recording does not "
                           "show this effect",
                           range.nearest(parameter.value));
    result.objections.push_back(
        fmt::format("{} came out as {}; {} is possible: {}", name_of(result, parameter),
                    value_words(result, parameter), range.words_at(parameter.value), cause));
  }
  for (const FittedLink& link : result.fit.links) {
    if (link.factor > 0) continue;
    result.objections.push_back(
        fmt::format("mass and inertia of link {} came out negative", link.link + 1));
  }
}

// What no range of one number says. Nothing where a number is beyond its own: that says more.
void object_to_friction(const Measurement& log, AddResult& result) {
  if (!result.objections.empty()) return;
  std::set<std::size_t> joints;
  for (const FittedParameter& parameter : result.fit.parameters) {
    const RobotEffect& effect = result.robot.effects[parameter.effect];
    if (parameter.fitted && is_friction(effect.kind)) joints.insert(effect.joint);
  }
  for (const std::size_t joint : joints) {
    const auto torque = log.torque.col(static_cast<Index>(joint));
    const double rms = torque.norm() / std::sqrt(static_cast<double>(torque.size()));
    if (const auto drives = friction_that_drives(result.robot, joint, log.motion, rms)) {
      result.objections.push_back(drives->words(result.robot));
    }
  }
}

void note_what_changed(const AddSetup& setup, const AddRequest& request, AddResult& result) {
  for (const FittedParameter& parameter : result.fit.parameters) {
    if (parameter.fitted) result.robot.effects[parameter.effect].source = request.source;
  }
  for (const FittedLink& link : result.fit.links) {
    std::string& source = result.robot.joints[link.link].source;
    if (!source.empty()) source += " ";
    source += fmt::format("Mass and inertia times {:.6g}: {}.", link.factor, request.source);
  }
  if (setup.refitted.empty()) return;
  std::vector<std::string> names;
  for (const std::size_t effect : setup.refitted) {
    const RobotEffect& of = result.robot.effects[effect];
    names.push_back(fmt::format("{} on joint {}", info_of(of.kind)->name, of.joint + 1));
  }
  result.notes.push_back("fitted again together with it: " + list_of(names));
}

// On data that the fit has not seen: the joint that was asked for must gain, no other may lose more
// than what a twentieth is.
void doubt_what_held_out_data_say(const AddRequest& request, AddResult& result) {
  constexpr double kRelevant = 0.05;
  for (const BeforeAfter& error : result.held_out) {
    const bool asked = error.joint == request.joint;
    if (asked ? error.fall() > 0 : !(error.fall() < -kRelevant)) continue;
    result.doubts.push_back(
        fmt::format("on data not used for the fit the error of joint {} {}, from {:.2f} % to "
                    "{:.2f} %: these data do not support the effect",
                    error.joint + 1, asked ? "does not fall" : "rises", error.before_percent,
                    error.after_percent));
  }
}

// What is in the file already and would fit best beyond its end, but not so that the recording
// contradicts the end: there it is held, and all else is fitted beside it.
bool hold_one(const FitProblem& problem, AddSetup& setup, AddResult& result) {
  for (const Beyond& one : beyond_their_ranges(problem, result)) {
    const FittedParameter& parameter = one.parameter;
    const PhysicalRange& range = one.range;
    if (one.contradicted || parameter.effect >= setup.added.front()) continue;
    RobotEffect& effect = setup.robot.effects[parameter.effect];
    const double end = range.nearest(parameter.value);
    result.notes.push_back(fmt::format(
        "{} was held at {:g}: {} is possible, and free it came out as {}, and {:g} fits as well",
        name_of(result, parameter), end, range.words_at(parameter.value),
        value_words(result, parameter), end));
    effect.parameters[parameter.parameter] = end;
    std::erase_if(setup.unknowns, [&](const Unknown& unknown) {
      return unknown.kind == Unknown::Kind::kEffectParameter &&
             unknown.effect == parameter.effect && unknown.parameter == parameter.parameter;
    });
    return true;
  }
  return false;
}

}  // namespace

AddResult add(const RobotDescription& robot, const AddRequest& request, const Measurement& log,
              const Measurement* holdout, const OnStep& on_step) {
  AddSetup setup = set_up(robot, request);
  AddResult result;
  result.added = setup.added;
  std::optional<FitProblem> problem;
  std::optional<std::vector<int>> parts;
  do {
    RobotDescription start = setup.robot;
    std::vector<ShapeGroup> groups = make_shape_groups(
        start, setup.added, setup.refitted, setup.given, log.motion, log.plan.torque_cutoff_hz);
    problem.emplace(settled({std::move(start), setup.unknowns, std::move(groups), log}, on_step));
    if (holdout == nullptr) {
      parts = contiguous_parts(problem->samples(), log.plan.edge_samples / log.plan.decimation + 1);
    }
    result.fit = fit(*problem, parts, on_step);
    result.robot = result.fit.robot;
  } while (hold_one(*problem, setup, result));
  result.cross_validated = holdout == nullptr;
  const Comparison before = compare(robot, log);
  const Comparison after = compare(result.robot, log);
  result.fitted_log = before_after(before, after);
  if (holdout != nullptr) {
    result.before = compare(robot, *holdout);
    result.after = compare(result.robot, *holdout);
    result.held_out = before_after(result.before, result.after);
  } else {
    result.before = before;
    result.after = after;
    result.held_out = both_held_out(before, result.fit, *parts);
  }
  object_to_indistinct(setup.unknowns, result);
  object_to_ranges(*problem, result);
  object_to_friction(log, result);
  doubt_what_held_out_data_say(request, result);
  note_indistinct(result);
  note_lookalikes(*problem, result);
  note_what_changed(setup, request, result);
  return result;
}

}  // namespace offnominal::tools
