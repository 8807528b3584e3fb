#include "studio/workbench.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "common/error.hpp"
#include "identify/add_report.hpp"
#include "identify/add_setup.hpp"
#include "studio/refused.hpp"

namespace offnominal::desk::studio {
namespace {

// A fit holds the curves of every recording.
constexpr std::size_t kMostKnown = 64;

std::vector<Measurement> measured(const std::vector<Log>& logs, const RobotDescription& robot,
                                  const FilterPlan& plan) {
  std::vector<Measurement> all;
  for (const Log& log : logs) all.push_back(measure(log, robot, plan));
  return all;
}

Comparisons compare_all(const RobotDescription& robot, const std::vector<Measurement>& all) {
  std::vector<Comparison> comparisons;
  for (const Measurement& one : all) comparisons.push_back(compare(robot, one));
  return together(std::move(comparisons));
}

}  // namespace

Workbench::Workbench(Input input) : input_(std::move(input)) {
  const Treated& recordings = *input_.recordings;
  for (const std::vector<Log>* group : {&recordings.logs, &recordings.holdout}) {
    for (const Log& log : *group) require_joints(log, input_.robot);
  }
  const FilterPlan plan = plan_filter(recordings.logs, input_.robot);
  measured_ = measured(recordings.logs, input_.robot, plan);
  measured_held_out_ = measured(recordings.holdout, input_.robot, plan);
  start_ = compared(input_.robot);
  now_ = start_;
}

Compared Workbench::compared(const RobotDescription& robot) const {
  Compared all{compare_all(robot, measured_), std::nullopt};
  if (!measured_held_out_.empty()) all.held_out = compare_all(robot, measured_held_out_);
  return all;
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
    static_cast<void>(set_up(robot(), request_of({0, kind, joint})));
    return {};
  } catch (const InputError& error) {
    const InputProblem& problem = error.problem();
    return problem.allowed.empty() ? problem.found
                                   : problem.found + "; allowed: " + problem.allowed;
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
  if (std::erase_if(steps, [&](const Step& step) { return step.id == id; }) == 0) {
    throw Refused(Refused::Why::kBadRequest, fmt::format("There is no step {} to undo.", id));
  }
  take(std::move(steps));
}

void Workbench::take(std::vector<Step> steps) {
  std::vector<Fit> fits = fits_of(steps);
  const RobotDescription& robot = fits.empty() ? input_.robot : fits.back()->result.robot;
  Compared now = fits.empty() ? start_ : compared(robot);
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
  auto made = std::make_shared<const Fitted>(Fitted{
      request, desk::add(robot, request, input_.recordings->logs, input_.recordings->holdout)});
  if (!made->result.objections.empty()) {
    throw Refused(Refused::Why::kNotNow, verdict_of(made->result, request));
  }
  if (known_.size() >= kMostKnown) known_.clear();
  known_.emplace(key, made);
  return made;
}

}  // namespace offnominal::desk::studio
