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

VectorXd set_sign_widths(RobotDescription& robot, const std::vector<Log>& logs,
                         const FilterPlan& plan) {
  VectorXd widths = resolved_sign_widths(logs, plan);
  set_sign_widths(robot, widths);
  return widths;
}

}  // namespace offnominal::desk
