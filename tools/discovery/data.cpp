#include "discovery/data.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "discovery/effects/effects.hpp"
#include "signal/quantile.hpp"

namespace offnominal::tools::discovery {

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

double sample_rate_of(const Log& log) {
  constexpr double kBlocks = 300;
  constexpr double kFewestReadings = 5;
  if (!log.at_rest) return log.sample_rate_hz();
  const auto readings = static_cast<double>(log.sample_count());
  return std::max(kFewestReadings, readings / kBlocks) / kShortestBlockS;
}

FilterPlan plan_for(const Log& log, FilterPlan plan) {
  plan.sample_rate_hz = sample_rate_of(log);
  return plan;
}

FilterPlan discovery_filter(const std::vector<Log>& logs, const RobotDescription& robot) {
  if (logs.front().at_rest) {
    FilterPlan none;
    none.sample_rate_hz = sample_rate_of(logs.front());
    none.position_cutoff_hz = std::numeric_limits<double>::infinity();
    none.torque_cutoff_hz = std::numeric_limits<double>::infinity();
    return none;
  }
  // An encoder step, uniformly distributed, twice differentiated and low-passed, may make an
  // acceleration error of this share of the motion's own.
  constexpr double kShare = 0.02;
  constexpr double kHighestHz = 12;
  constexpr double kLowestHz = 8;
  double cutoff_hz = kHighestHz;
  for (const Log& log : logs) {
    const double rate_hz = log.sample_rate_hz();
    cutoff_hz = std::min(cutoff_hz, 0.2 * rate_hz);
    for (Index joint = 0; joint < log.q.cols(); ++joint) {
      const double counts = robot.joints[static_cast<std::size_t>(joint)].encoder.counts_per_unit;
      if (!(counts > 0)) continue;
      const double noise = 1 / counts / std::sqrt(12.0);
      const FilterPlan coarse = [&] {
        FilterPlan plan;
        plan.sample_rate_hz = rate_hz;
        plan.position_cutoff_hz = kLowestHz;
        return plan;
      }();
      const VectorXd ddq = motion_of(log, coarse).ddq.col(joint);
      const double moves = std::sqrt(ddq.squaredNorm() / static_cast<double>(ddq.size()));
      // Power of white noise over f, differentiated twice: (2 pi)^4 f^5 / 5 per rate / 2.
      const double f5 =
          5 * rate_hz / 2 * std::pow(kShare * moves / noise, 2) / std::pow(2 * std::numbers::pi, 4);
      const double highest = std::pow(f5, 0.2);
      if (highest > 0) cutoff_hz = std::min(cutoff_hz, std::max(highest, kLowestHz));
    }
  }
  const Log& first = logs.front();
  FilterPlan plan;
  plan.sample_rate_hz = first.sample_rate_hz();
  plan.torque_cutoff_hz = cutoff_hz;
  plan.position_cutoff_hz = std::min(2.5 * cutoff_hz, 0.45 * plan.sample_rate_hz);
  plan.decimation =
      std::max<Index>(1, static_cast<Index>(std::floor(plan.sample_rate_hz / (2.5 * cutoff_hz))));
  plan.edge_samples = static_cast<Index>(std::ceil(2 * plan.sample_rate_hz / cutoff_hz));
  return plan;
}

namespace {

bool is_width(const RobotEffect& effect, std::size_t parameter) {
  return std::string_view(info_of(effect.kind)->parameters[parameter].name) ==
         effects::kSmoothing.name;
}

void set_width(RobotDescription& robot, Index joint, double width) {
  for (RobotEffect& effect : robot.effects) {
    if (effect.joint != joint) continue;
    for (std::size_t p = 0; p < info_of(effect.kind)->parameters.size(); ++p) {
      if (is_width(effect, p)) effect.parameters[p] = width;
    }
  }
}

}  // namespace

VectorXd set_sign_widths(RobotDescription& robot, const std::vector<Log>& logs,
                         const FilterPlan& plan) {
  constexpr double kShareOfTopSpeed = 0.004;
  VectorXd widths = VectorXd::Zero(robot.joint_count());
  for (const Log& log : logs) {
    const MatrixXd dq = motion_of(log, plan).dq;
    for (Index joint = 0; joint < robot.joint_count(); ++joint) {
      const double top = quantile(dq.col(joint).cwiseAbs(), kTopSpeedShare);
      widths[joint] = std::max(widths[joint], kShareOfTopSpeed * top);
    }
  }
  for (Index joint = 0; joint < robot.joint_count(); ++joint) {
    if (widths[joint] > 0) set_width(robot, joint, widths[joint]);
  }
  return widths;
}

}  // namespace offnominal::tools::discovery
