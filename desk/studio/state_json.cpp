#include "studio/state_json.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "explain/data_fault_report.hpp"
#include "identify/add_report.hpp"
#include "log/log.hpp"
#include "robot/read_effect.hpp"

namespace offnominal::desk::studio {

using nlohmann::ordered_json;

namespace {

ordered_json errors_of(const Workbench& bench, std::size_t joint, std::size_t steps) {
  return {{"fitted_percent", number_or_null(bench.fitted_percent(joint, steps))},
          {"held_out_percent", number_or_null(bench.held_out_percent(joint, steps))}};
}

// The errors of a step's joint without it and with it, as `add` prints them: where parts of the
// recordings are held out, those that are predicted without it may differ from step to step.
struct OfStep {
  ordered_json before;
  ordered_json after;
};
OfStep errors_of_step(const Workbench& bench, std::size_t step) {
  const std::size_t joint = bench.steps()[step].joint;
  OfStep errors{errors_of(bench, joint, step), errors_of(bench, joint, step + 1)};
  for (const BeforeAfter& one : bench.fitted(step).result.held_out) {
    if (one.joint != joint) continue;
    errors.before["held_out_percent"] = number_or_null(one.before_percent);
    errors.after["held_out_percent"] = number_or_null(one.after_percent);
  }
  return errors;
}

ordered_json recordings_of(const Input& input) {
  ordered_json all = ordered_json::array();
  const auto put = [&](const std::vector<Log>& logs, bool held_out) {
    for (const Log& log : logs) {
      all.push_back({{"name", log.file},
                     {"held_out", held_out},
                     {"from_s", log.t_s[0]},
                     {"to_s", log.t_s[log.t_s.size() - 1]},
                     {"samples", log.sample_count()},
                     {"rate_hz", log.sample_rate_hz()},
                     {"remarks", log.remarks}});
    }
  };
  put(input.recordings->logs, false);
  put(input.recordings->holdout, true);
  return all;
}

ordered_json hints_of(const std::vector<DataFault>& faults) {
  ordered_json hints = ordered_json::array();
  for (const DataFault& fault : faults) {
    const bool out = !fault.left_out_of.empty();
    hints.push_back(out ? "Left out: " + left_out_line(fault) : line_of(fault));
  }
  return hints;
}

bool moves(const Workbench& bench, std::size_t joint) {
  for (const Log& log : bench.input().recordings->logs) {
    const auto q = log.q.col(static_cast<Eigen::Index>(joint));
    if (q.maxCoeff() > q.minCoeff()) return true;
  }
  return false;
}

// "file": the robot file has it; else the ids of the steps that added it.
ordered_json effects_of(const Workbench& bench, std::size_t joint) {
  ordered_json all = ordered_json::array();
  for (const EffectInfo* info : file_effects()) {
    ordered_json steps = ordered_json::array();
    for (const Step& step : bench.steps()) {
      if (step.kind == info->kind && step.joint == joint) steps.push_back(step.id);
    }
    bool in_file = false;
    for (const RobotEffect& effect : bench.input().robot.effects) {
      in_file = in_file || (effect.kind == info->kind && effect.joint == joint && !effect.of_motor);
    }
    all.push_back({{"effect", info->name},
                   {"words", info->words},
                   {"formula", info->formula},
                   {"in_file", in_file},
                   {"steps", std::move(steps)},
                   {"may_repeat", info->may_repeat()},
                   {"why_not", bench.why_not(info->kind, joint)}});
  }
  return all;
}

ordered_json joints_of(const Workbench& bench) {
  ordered_json all = ordered_json::array();
  const std::size_t steps = bench.steps().size();
  for (std::size_t joint = 0; joint < bench.robot().joints.size(); ++joint) {
    all.push_back({{"joint", joint + 1},
                   {"name", bench.robot().joints[joint].name},
                   {"unit", bench.start().fitted.joints[joint].unit},
                   {"moves", moves(bench, joint)},
                   {"start", errors_of(bench, joint, 0)},
                   {"now", errors_of(bench, joint, steps)},
                   {"effects", effects_of(bench, joint)}});
  }
  return all;
}

// Of every fitted number of a step: what it is with all steps, and how far the page lets it be
// dragged: as far as it is large, or as its interval is wide, within what the effect can have.
ordered_json draggable_of(const Workbench& bench, const Step& step, const Fitted& fitted) {
  ordered_json all = ordered_json::object();
  const RobotEffect& now = bench.effect(step.id);
  for (const FittedParameter& one : fitted.result.fit.parameters) {
    if (!one.fitted || one.effect != fitted.result.added.front()) continue;
    const ParameterInfo& info = info_of(step.kind)->parameters[one.parameter];
    const double value = now.parameters[one.parameter];
    const double width = one.ci95 ? (*one.ci95)[1] - (*one.ci95)[0] : 0;
    const double reach = std::max(std::abs(value), width);
    if (!(reach > 0)) continue;
    all[info.name] = {{"value", value},
                      {"low", std::max(info.min, value - reach)},
                      {"high", std::min(info.max, value + reach)}};
  }
  return all;
}

ordered_json steps_of(const Workbench& bench) {
  ordered_json all = ordered_json::array();
  for (std::size_t i = 0; i < bench.steps().size(); ++i) {
    const Step& step = bench.steps()[i];
    const Fitted& fitted = bench.fitted(i);
    OfStep errors = errors_of_step(bench, i);
    const ordered_json added = desk::to_json(fitted.result, fitted.request, AddNames{});
    all.push_back({{"id", step.id},
                   {"effect", info_of(step.kind)->name},
                   {"words", info_of(step.kind)->words},
                   {"joint", step.joint + 1},
                   {"parameters", added.at("parameters")},
                   {"draggable", draggable_of(bench, step, fitted)},
                   {"refitted", added.at("refitted")},
                   {"before", std::move(errors.before)},
                   {"after", std::move(errors.after)},
                   {"verdict", judgement_of(fitted.result, fitted.request)},
                   {"notes", fitted.result.notes},
                   {"doubts", fitted.result.doubts}});
  }
  return all;
}

}  // namespace

ordered_json number_or_null(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

ordered_json state_of(const Workbench& bench) {
  const Input& input = bench.input();
  return {{"robot", {{"name", input.robot.name}, {"file", input.robot_file}}},
          {"held_out", bench.start().held_out ? "recordings" : "parts"},
          {"recordings", recordings_of(input)},
          {"hints", hints_of(input.recordings->faults)},
          {"joints", joints_of(bench)},
          {"steps", steps_of(bench)}};
}

}  // namespace offnominal::desk::studio
