#include "identify/data.hpp"

#include <algorithm>
#include <cmath>

#include "compare/standstill.hpp"
#include "identify/effects/effects.hpp"
#include "identify/sign_width.hpp"
#include "signal/quantile.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Data::Data(std::vector<Workspace> made, const RobotDescription& robot,
           const NuisanceOptions& options)
    : recordings(std::move(made)),
      layout(recordings),
      nuisance(make_nuisance(robot, recordings, layout, options)) {
  std::vector<const MatrixXd*> measured;
  std::vector<const MatrixXd*> model;
  for (const Workspace& at : recordings) {
    measured.push_back(&at.torque);
    model.push_back(&at.model_torque);
  }
  torque = layout.stack_all(recordings, measured);
  target = torque - layout.stack_all(recordings, model);
}

Data::Data(const Data& same, const RobotDescription& robot, const NuisanceOptions& options)
    : recordings(same.recordings),
      layout(same.layout),
      nuisance(make_nuisance(robot, recordings, layout, options)),
      torque(same.torque),
      target(same.target),
      cache(same.cache) {}

VectorXd resolved_sign_widths(const std::vector<Log>& logs, const FilterPlan& plan) {
  constexpr double kShareOfTopSpeed = 0.004;
  VectorXd widths = VectorXd::Zero(logs.front().q.cols());
  for (const Log& log : logs) {
    const MatrixXd dq = motion_of(log, plan).dq;
    for (Index joint = 0; joint < widths.size(); ++joint) {
      const double top = quantile(dq.col(joint).cwiseAbs(), kTopSpeedShare);
      widths[joint] = std::max(widths[joint], kShareOfTopSpeed * top);
    }
  }
  return widths;
}

void set_sign_widths(RobotDescription& robot, const VectorXd& widths) {
  for (Index joint = 0; joint < robot.joint_count(); ++joint) {
    if (widths[joint] > 0) set_sign_width(robot, joint, widths[joint]);
  }
}

namespace {

// Error of the robot file as it is, rms per joint.
VectorXd errors_of(const RobotDescription& robot, std::vector<Workspace> recordings) {
  for (Workspace& at : recordings) at.set_model(robot);
  NuisanceOptions none;
  none.free_effects = std::vector<std::size_t>{};
  none.link_share = 0;
  none.skew_samples = 0;
  none.sign_shapes = false;
  const Data data(std::move(recordings), robot, none);
  return data.layout.rms(data.target);
}

}  // namespace

VectorXd settle_sign_widths(const VectorXd& resolved, RobotDescription& robot,
                            std::vector<Workspace>& recordings) {
  constexpr double kClearly = 0.9;
  VectorXd widths = resolved;
  std::vector<std::size_t> fitted;
  for (std::size_t i = 0; i < robot.effects.size(); ++i) {
    if (robot.effects[i].fitted) fitted.push_back(i);
  }
  const VectorXd own = settled_sign_widths(robot, fitted);
  if ((own.array() > 0).any()) {
    RobotDescription other = robot;
    set_sign_widths(other, resolved);
    const VectorXd with_own = errors_of(robot, recordings);
    const VectorXd with_resolved = errors_of(other, recordings);
    for (Index joint = 0; joint < widths.size(); ++joint) {
      const bool better = with_own[joint] < kClearly * with_resolved[joint];
      if (own[joint] > 0 && better) widths[joint] = own[joint];
    }
  }
  set_sign_widths(robot, widths);
  for (Workspace& at : recordings) {
    at.set_model(robot);
    at.set_sign_width(widths);
  }
  return widths;
}

VectorXd set_sign_widths(RobotDescription& robot, const std::vector<Log>& logs,
                         const FilterPlan& plan) {
  VectorXd widths = resolved_sign_widths(logs, plan);
  set_sign_widths(robot, widths);
  return widths;
}

}  // namespace offnominal::desk
