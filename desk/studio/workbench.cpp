#include "studio/workbench.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "common/error.hpp"
#include "common/refused.hpp"
#include "identify/add_report.hpp"
#include "identify/add_setup.hpp"
#include "robot/read_effect.hpp"

namespace offnominal::desk::studio {
namespace {

// A fit holds the curves of every recording: at most so much of them is kept, bytes.
constexpr double kMostKept = 512e6;

// Of two models on one and of one on the other, as a fit keeps them.
double bytes_of(const Compared& compared) {
  Eigen::Index numbers = 0;
  const auto count = [&](const Comparisons& all) {
    for (const Comparison& one : all.recordings) numbers += 7 * one.measured.size();
  };
  count(compared.fitted);
  if (compared.held_out) count(*compared.held_out);
  return 2 * sizeof(double) * static_cast<double>(numbers);
}

}  // namespace

std::optional<EffectKind> effect_named(const std::string& name) {
  for (const EffectInfo* info : file_effects()) {
    if (name == info->name) return info->kind;
  }
  return std::nullopt;
}

const Comparison& recording_of(const Compared& compared, std::size_t recording) {
  const std::vector<Comparison>& fitted = compared.fitted.recordings;
  return recording < fitted.size() ? fitted[recording]
                                   : compared.held_out->recordings[recording - fitted.size()];
}

Workbench::Workbench(Input input)
    : input_(std::move(input)), memory_(input_.recordings->logs, input_.recordings->holdout) {
  const Treated& recordings = *input_.recordings;
  for (const std::vector<Log>* group : {&recordings.logs, &recordings.holdout}) {
    for (const Log& log : *group) require_joints(log, input_.robot);
  }
  start_ = compared_with(input_.robot);
  now_ = start_;
  most_known_ = static_cast<std::size_t>(std::clamp(kMostKept / bytes_of(start_), 4.0, 64.0));
}

Compared Workbench::compared(const Fitted& last) {
  const AddResult& result = last.result;
  if (result.cross_validated) return {result.after, std::nullopt};
  return {result.after_fitted, result.after};
}

Compared Workbench::compared_with(const RobotDescription& robot) {
  Compared made{memory_.compared(robot), std::nullopt};
  if (!input_.recordings->holdout.empty()) made.held_out = memory_.compared_held_out(robot);
  return made;
}

const Step& Workbench::step(std::size_t id) const {
  const auto found =
      std::find_if(steps_.begin(), steps_.end(), [&](const Step& one) { return one.id == id; });
  if (found != steps_.end()) return *found;
  throw Refused(Refused::Why::kBadRequest, fmt::format("There is no step {}.", id));
}

std::size_t Workbench::effect_of(std::size_t id) const {
  const auto at = static_cast<std::size_t>(&step(id) - steps_.data());
  return fits_[at]->result.added.front();
}

RobotDescription Workbench::robot_without(std::size_t id) const {
  RobotDescription without = robot();
  without.effects.erase(without.effects.begin() + static_cast<std::ptrdiff_t>(effect_of(id)));
  return without;
}

RobotDescription Workbench::robot_with(std::size_t id, const std::string& parameter,
                                       double value) const {
  RobotDescription moved = robot();
  RobotEffect& effect = moved.effects[effect_of(id)];
  const auto parameters = info_of(effect.kind)->parameters;
  const auto found = std::find_if(parameters.begin(), parameters.end(),
                                  [&](const auto& one) { return parameter == one.name; });
  if (found == parameters.end()) {
    throw Refused(Refused::Why::kBadRequest, "The effect has no such parameter.");
  }
  if (!(value >= found->min && value <= found->max)) {
    throw Refused(Refused::Why::kBadRequest,
                  fmt::format("{} has to be {} to {}.", parameter, found->min, found->max));
  }
  effect.parameters[static_cast<std::size_t>(found - parameters.begin())] = value;
  return moved;
}

const RobotDescription& Workbench::robot_after(std::size_t steps) const {
  return steps == 0 ? input_.robot : fits_[steps - 1]->result.robot;
}

double Workbench::fitted_percent(std::size_t joint, std::size_t steps) const {
  if (steps == 0) return start_.fitted.joints[joint].relative_error_percent;
  return fits_[steps - 1]->result.fitted_logs[joint].after_percent;
}

double Workbench::held_out_percent(std::size_t joint, std::size_t steps) const {
  if (start_.held_out && steps == 0) return start_.held_out->joints[joint].relative_error_percent;
  // Where parts are held out, a fit says nothing of joints that it does not touch.
  const auto entry = [&](std::size_t step) -> const BeforeAfter* {
    const std::vector<BeforeAfter>& all = fits_[step]->result.held_out;
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const BeforeAfter& one) { return one.joint == joint; });
    return found == all.end() ? nullptr : &*found;
  };
  for (std::size_t step = steps; step-- > 0;) {
    if (const BeforeAfter* one = entry(step)) return one->after_percent;
  }
  for (std::size_t step = steps; step < fits_.size(); ++step) {
    if (const BeforeAfter* one = entry(step)) return one->before_percent;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

AddRequest Workbench::request_of(const Step& step) const {
  AddRequest request;
  request.effects = {step.kind};
  request.joint = step.joint;
  request.source = input_.source;
  return request;
}

std::string Workbench::why_not(EffectKind kind, std::size_t joint) const {
  try {
    const AddRequest request = request_of({0, kind, joint});
    static_cast<void>(set_up(robot(), request));
    for (const auto* some : {&input_.recordings->logs, &input_.recordings->holdout}) {
      for (const Log& log : *some) check_sensors(robot(), request, log);
    }
    return {};
  } catch (const InputError& error) {
    const InputProblem& problem = error.problem();
    std::string words = problem.place.empty() ? "" : problem.place + ": ";
    words += problem.found;
    return problem.allowed.empty() ? words : words + "; allowed: " + problem.allowed;
  }
}

void Workbench::add(EffectKind kind, std::size_t joint) {
  std::vector<Step> steps = steps_;
  steps.push_back({next_id_, kind, joint});
  take(std::move(steps));
  ++next_id_;
}

void Workbench::undo(std::size_t id) {
  std::vector<Step> steps = steps_;
  steps.erase(steps.begin() + (&step(id) - steps_.data()));
  take(std::move(steps));
}

void Workbench::take(std::vector<Step> steps) {
  std::vector<Fit> fits = fits_of(steps);
  Compared now = fits.empty() ? start_ : compared(*fits.back());
  steps_ = std::move(steps);
  fits_ = std::move(fits);
  now_ = std::move(now);
}

std::vector<Workbench::Fit> Workbench::fits_of(const std::vector<Step>& steps) {
  std::vector<Fit> fits;
  std::string key;
  for (const Step& step : steps) {
    key += fmt::format("{}@{};", static_cast<int>(step.kind), step.joint);
    fits.push_back(fit(fits.empty() ? input_.robot : fits.back()->result.robot, step, key));
  }
  return fits;
}

Workbench::Fit Workbench::fit(const RobotDescription& robot, const Step& step,
                              const std::string& key) {
  const auto known = known_.find(key);
  if (known != known_.end()) return known->second;
  const AddRequest request = request_of(step);
  auto made = std::make_shared<const Fitted>(Fitted{request, desk::add(robot, request, memory_)});
  if (!made->result.objections.empty()) {
    throw Refused(Refused::Why::kNotNow, "Not added: " + judgement_of(made->result, request));
  }
  if (known_.size() >= most_known_) known_.clear();
  known_.emplace(key, made);
  return made;
}

}  // namespace offnominal::desk::studio
