#include "discovery/workspace.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/inverse_model.hpp"
#include "signal/zero_phase.hpp"

namespace offnominal::tools::discovery {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

double top_speed_of(const Eigen::Ref<const VectorXd>& dq) {
  VectorXd speed = dq.cwiseAbs();
  const auto rank = static_cast<Index>(0.99 * static_cast<double>(speed.size() - 1));
  std::nth_element(speed.data(), speed.data() + rank, speed.data() + speed.size());
  return speed[rank];
}

}  // namespace

Eigen::ArrayXd Workspace::sign(Index joint) const {
  return (motion.dq.col(joint).array() / sign_width[joint]).tanh();
}

namespace {

MatrixXd every_row(const MatrixXd& rows, Index stride) {
  MatrixXd kept((rows.rows() + stride - 1) / stride, rows.cols());
  for (Index i = 0; i < kept.rows(); ++i) kept.row(i) = rows.row(i * stride);
  return kept;
}

// Everything that is left after the low-pass, at a rate that keeps it.
FilterPlan thinned(const FilterPlan& plan, Index stride) {
  FilterPlan thin = plan;
  const auto by = static_cast<double>(stride);
  thin.sample_rate_hz = plan.sample_rate_hz / by;
  thin.decimation = std::max<Index>(1, std::lround(static_cast<double>(plan.decimation) / by));
  thin.edge_samples = static_cast<Index>(std::ceil(static_cast<double>(plan.edge_samples) / by));
  return thin;
}

void differentiate_load(Workspace& at) {
  at.own_inertia.resize(at.sample_count(), at.joint_count());
  for (Index joint = 0; joint < at.joint_count(); ++joint) {
    Motion faster = at.motion;
    faster.ddq.col(joint).array() += 1;
    at.own_inertia.col(joint) = (model_torque(at.rigid, faster) - at.load_torque).col(joint);
  }
}

// From what a low-pass takes away, as if white; 0 where the low-pass takes nothing.
double noise_density(const VectorXd& raw, const VectorXd& smooth, const FilterPlan& plan) {
  const double band_hz = plan.sample_rate_hz / 2 - plan.position_cutoff_hz;
  if (!(band_hz > 0)) return 0;
  const VectorXd fast = raw - smooth;
  return std::sqrt(fast.squaredNorm() / static_cast<double>(fast.size()) / band_hz);
}

}  // namespace

Workspace make_workspace(const Log& log, const RobotDescription& robot, const FilterPlan& plan,
                         const VectorXd& sign_width) {
  constexpr double kRatePerCutoff = 20;
  const auto stride = std::max<Index>(
      1, static_cast<Index>(plan.sample_rate_hz / (kRatePerCutoff * plan.torque_cutoff_hz)));
  Workspace at;
  at.plan = thinned(plan, stride);
  const Motion full = motion_of(log, plan);
  at.motion = {every_row(full.t_s, stride), every_row(full.q, stride), every_row(full.dq, stride),
               every_row(full.ddq, stride)};
  MatrixXd torque = log.tau;
  at.torque_noise_density.resize(torque.cols());
  for (Index joint = 0; joint < torque.cols(); ++joint) {
    const VectorXd raw = log.tau.col(joint);
    const VectorXd smooth = zero_phase_low_pass(raw, plan.position_cutoff_hz, plan.sample_rate_hz);
    at.torque_noise_density[joint] = noise_density(raw, smooth, plan);
    if (stride > 1) torque.col(joint) = smooth;
  }
  at.torque = every_row(torque, stride);
  at.start_s = log.t_s[0];
  at.skew_s = log.period_s;
  at.rigid = robot;
  at.known_effects = robot.effects;
  at.rigid.effects.clear();
  at.load_torque = model_torque(at.rigid, at.motion);
  at.model_torque = robot.effects.empty() ? at.load_torque : model_torque(robot, at.motion);
  differentiate_load(at);
  at.sign_width = sign_width;
  at.top_speed = VectorXd::Zero(log.q.cols());
  for (Index joint = 0; joint < log.q.cols(); ++joint) {
    at.top_speed[joint] = top_speed_of(at.motion.dq.col(joint));
    if (!(at.sign_width[joint] > 0)) {
      constexpr double kStill = 1e-9;
      at.sign_width[joint] = std::max(0.01 * at.top_speed[joint], kStill);
    }
  }
  return at;
}

}  // namespace offnominal::tools::discovery
