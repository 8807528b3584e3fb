#include "analysis/add.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/add_setup.hpp"
#include "analysis/lookalike.hpp"
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

void object_to_ranges(AddResult& result) {
  for (const FittedParameter& parameter : result.fit.parameters) {
    const RobotEffect& effect = result.robot.effects[parameter.effect];
    const ParameterInfo& info = info_of(effect.kind)->parameters[parameter.parameter];
    if (parameter.value >= info.min && parameter.value <= info.max) continue;
    const bool below = parameter.value < info.min;
    result.objections.push_back(
        fmt::format("{}.{} came out as {:.6g} {}, {:g} or {} is possible: the recording does not "
                    "show this effect",
                    info_of(effect.kind)->name, info.name, parameter.value,
                    unit_of(info.quantity, result.robot.joints[effect.joint].joint.type),
                    below ? info.min : info.max, below ? "more" : "less"));
  }
  for (const FittedLink& link : result.fit.links) {
    if (link.factor > 0) continue;
    result.objections.push_back(
        fmt::format("mass and inertia of link {} came out negative", link.link + 1));
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
    names.emplace_back(info_of(result.robot.effects[effect].kind)->name);
  }
  result.notes.push_back("fitted again together with it: " + list_of(names));
}

}  // namespace

AddResult add(const RobotDescription& robot, const AddRequest& request, const Measurement& log,
              const Measurement* holdout, const OnStep& on_step) {
  AddSetup setup = set_up(robot, request);
  std::vector<ShapeGroup> groups = make_shape_groups(
      setup.robot, setup.added, setup.refitted, setup.given, log.motion, log.plan.torque_cutoff_hz);
  const FitProblem problem =
      settled({setup.robot, setup.unknowns, std::move(groups), log}, on_step);
  std::optional<std::vector<int>> parts;
  if (holdout == nullptr) {
    parts = contiguous_parts(problem.samples(), log.plan.edge_samples / log.plan.decimation + 1);
  }

  AddResult result;
  result.added = setup.added;
  result.fit = fit(problem, parts, on_step);
  result.robot = result.fit.robot;
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
  object_to_ranges(result);
  note_indistinct(result);
  note_lookalikes(problem, result);
  note_what_changed(setup, request, result);
  return result;
}

}  // namespace offnominal::tools
