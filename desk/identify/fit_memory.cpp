#include "identify/fit_memory.hpp"

#include <algorithm>
#include <utility>

#include "identify/data.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {
namespace {

bool are_same(const std::vector<Stretch>& a, const std::vector<Stretch>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Stretch& x, const Stretch& y) {
    return x.log == y.log && x.first == y.first && x.samples == y.samples && x.margin == y.margin;
  });
}

}  // namespace

const FilterPlan& FitMemory::plan(const RobotDescription& robot) {
  if (!plan_) plan_ = plan_filter(logs_, robot, filter_);
  return *plan_;
}

const Eigen::VectorXd& FitMemory::sign_widths(const RobotDescription& robot) {
  if (!sign_widths_) sign_widths_ = resolved_sign_widths(logs_, plan(robot));
  return *sign_widths_;
}

std::vector<Workspace> FitMemory::workspaces(const RobotDescription& robot,
                                             const Eigen::VectorXd& sign_width) {
  std::vector<Stretch> stretches = stretches_of(logs_, robot, plan(robot));
  if (workspaces_.empty() || !are_same(stretches, stretches_)) {
    workspaces_ = searched_workspaces(stretches, robot, plan(robot), sign_width);
    stretches_ = std::move(stretches);
    inertial_ = std::make_shared<InertialColumns>();
  }
  std::vector<Workspace> made = workspaces_;
  for (Workspace& at : made) {
    at.set_model(robot);
    at.set_sign_width(sign_width);
  }
  return made;
}

// In ascending order of the recordings.
const Measurement& FitMemory::measured(const std::vector<Log>& logs, std::size_t recording,
                                       const RobotDescription& robot, Known& known) {
  if (known.measured.size() == recording) {
    known.measured.push_back(measure(held_elsewhere(logs[recording]), robot, plan(robot)));
    known.models.emplace_back();
  }
  return known.measured[recording];
}

Comparisons FitMemory::compare_one(const RobotDescription& robot, const std::vector<Log>& logs,
                                   Known& known) {
  std::vector<Comparison> all;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const Measurement& of = measured(logs, i, robot, known);
    all.push_back(compare(robot, of, known.models[i]));
  }
  if (for_ == For::kOneFit) known = {};
  return together(std::move(all));
}

FitMemory::Two FitMemory::compare_two(const RobotDescription& before, const RobotDescription& after,
                                      const std::vector<Log>& logs, Known& known) {
  const std::string text = for_ == For::kMany ? robot_text(before) : "";
  const bool is_known = !text.empty() && text == known.robot;
  known.robot.clear();  // its result is given away
  std::vector<Comparison> first;
  std::vector<Comparison> second;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const Measurement& of = measured(logs, i, before, known);
    ModelTorqueMemory& model = known.models[i];
    if (!is_known) first.push_back(compare(before, of, model));
    second.push_back(compare(after, of, model));
    if (for_ != For::kOneFit) continue;
    known.measured[i] = {};
    model = {};
  }
  Two two{is_known ? std::move(known.result) : together(std::move(first)),
          together(std::move(second))};
  if (for_ == For::kOneFit) {
    known = {};
    return two;
  }
  known.robot = robot_text(after);
  known.result = two.after;
  return two;
}

FitMemory::Two FitMemory::compared(const RobotDescription& before, const RobotDescription& after) {
  return compare_two(before, after, logs_, fitted_);
}

FitMemory::Two FitMemory::compared_held_out(const RobotDescription& before,
                                            const RobotDescription& after) {
  return compare_two(before, after, holdout_, held_out_);
}

}  // namespace offnominal::desk
