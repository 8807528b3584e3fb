#include "identify/data.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "compare/standstill.hpp"
#include "identify/effects/effects.hpp"
#include "identify/sign_width.hpp"
#include "signal/quantile.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

VectorXd stacked_torque(const RowLayout& layout, const std::vector<Workspace>& recordings,
                        MatrixXd Workspace::*torque) {
  std::vector<const MatrixXd*> torques;
  for (const Workspace& at : recordings) torques.push_back(&(at.*torque));
  return layout.stack_all(recordings, torques);
}

}  // namespace

Data::Data(std::vector<Workspace> made, std::shared_ptr<InertialColumns> inertial_columns,
           const RobotDescription& robot, const NuisanceOptions& options)
    : recordings(std::move(made)),
      layout(recordings),
      inertial(std::move(inertial_columns)),
      nuisance(make_nuisance(robot, recordings, layout, options, *inertial)),
      torque(stacked_torque(layout, recordings, &Workspace::torque)),
      target(torque - stacked_torque(layout, recordings, &Workspace::model_torque)),
      cache(std::make_shared<ColumnCache>(inertial)) {}

Data::Data(std::vector<Workspace> made, const RobotDescription& robot,
           const NuisanceOptions& options)
    : Data(std::move(made), std::make_shared<InertialColumns>(), robot, options) {}

Data::Data(const Data& same, const RobotDescription& robot, const NuisanceOptions& options)
    : recordings(same.recordings),
      layout(same.layout),
      inertial(same.inertial),
      nuisance(make_nuisance(robot, recordings, layout, options, *inertial)),
      torque(same.torque),
      target(same.target),
      cache(same.cache) {}

Data Data::of_robot(const Data& same, const RobotDescription& robot,
                    const NuisanceOptions& options) {
  std::vector<Workspace> recordings = same.recordings;
  for (Workspace& at : recordings) at.set_model(robot);
  return {std::move(recordings), same.inertial, robot, options};
}

VectorXd errors_as_it_is(const RobotDescription& file, const Data& data) {
  return errors_as_it_is(file, data.recordings, data.layout, data.torque);
}

VectorXd errors_as_it_is(const RobotDescription& file, std::vector<Workspace> recordings,
                         const RowLayout& layout, const VectorXd& torque) {
  for (Workspace& at : recordings) at.set_model(file);
  return layout.rms(torque - stacked_torque(layout, recordings, &Workspace::model_torque));
}

VectorXd resolved_sign_widths(const std::vector<Log>& logs, const FilterPlan& plan) {
  constexpr double kShareOfTopSpeed = 0.004;
  VectorXd widths = VectorXd::Zero(logs.front().q.cols());
  for (const Log& log : logs) {
    for (Index joint = 0; joint < widths.size(); ++joint) {
      const VectorXd dq = motion_of_joint(log, plan, joint).dq;
      const double top = quantile(dq.cwiseAbs(), kTopSpeedShare);
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
    const RowLayout layout(recordings);
    const VectorXd torque = stacked_torque(layout, recordings, &Workspace::torque);
    const VectorXd with_own = errors_as_it_is(robot, recordings, layout, torque);
    const VectorXd with_resolved = errors_as_it_is(other, recordings, layout, torque);
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
