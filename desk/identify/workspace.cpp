#include "identify/workspace.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "compare/inverse_model.hpp"
#include "compare/standstill.hpp"
#include "compare/transmission.hpp"
#include "compare/usable.hpp"
#include "identify/data.hpp"
#include "signal/decimate.hpp"
#include "signal/quantile.hpp"
#include "signal/zero_phase.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Everything that is left after the low-pass, at a rate that keeps it.
FilterPlan thinned(const FilterPlan& plan, Index stride) {
  FilterPlan thin = plan;
  const auto by = static_cast<double>(stride);
  thin.sample_rate_hz = plan.sample_rate_hz / by;
  thin.decimation = std::max<Index>(1, std::lround(static_cast<double>(plan.decimation) / by));
  thin.edge_samples = static_cast<Index>(std::ceil(static_cast<double>(plan.edge_samples) / by));
  return thin;
}

std::vector<MatrixXd> mass_columns(const Workspace& at) {
  std::vector<MatrixXd> columns;
  for (Index joint = 0; joint < at.joint_count(); ++joint) {
    Motion faster = at.motion;
    faster.ddq.col(joint).array() += 1;
    columns.emplace_back(desk::model_torque(at.rigid, faster) - at.load_torque);
  }
  return columns;
}

}  // namespace

Eigen::ArrayXd Workspace::sign(Index joint) const {
  return (motion.dq.col(joint).array() / sign_width[joint]).tanh();
}

VectorXd Workspace::dahl_state(Index joint, double width) const {
  const Effect<double> hysteresis{
      EffectKind::kHysteresis, static_cast<std::uint8_t>(joint), {1, width}};
  return torque_of_effect(hysteresis, joint_type(joint), motion);
}

std::vector<char> came_both_ways(const std::vector<Log>& logs) {
  std::vector<char> both(static_cast<std::size_t>(logs.front().q.cols()), 0);
  for (std::size_t joint = 0; joint < both.size(); ++joint) {
    bool up = false;
    bool down = false;
    for (const Log& log : logs) {
      if (!log.at_rest) continue;
      const auto approach = log.approach.col(static_cast<Index>(joint));
      up = up || approach.maxCoeff() > 0;
      down = down || approach.minCoeff() < 0;
    }
    both[joint] = static_cast<char>(up && down);
  }
  return both;
}

bool moves_in_any(const std::vector<Workspace>& recordings, Index joint) {
  return std::any_of(recordings.begin(), recordings.end(),
                     [&](const Workspace& at) { return at.top_speed[joint] > 0; });
}

double range_moved(const std::vector<Workspace>& recordings, Index joint) {
  double range = 0;
  for (const Workspace& at : recordings) {
    const auto q = at.motion.q.col(joint);
    range = std::max(range, q.maxCoeff() - q.minCoeff());
  }
  return range;
}

VectorXd ranges_moved(const std::vector<Workspace>& recordings) {
  VectorXd ranges(recordings.front().joint_count());
  for (Index joint = 0; joint < ranges.size(); ++joint) {
    ranges[joint] = range_moved(recordings, joint);
  }
  return ranges;
}

PositionSpan positions_seen(const std::vector<Workspace>& recordings, Index joint) {
  PositionSpan seen{std::numeric_limits<double>::infinity(),
                    -std::numeric_limits<double>::infinity()};
  for (const Workspace& at : recordings) {
    seen.low = std::min(seen.low, at.motion.q.col(joint).minCoeff());
    seen.high = std::max(seen.high, at.motion.q.col(joint).maxCoeff());
  }
  return seen;
}

double longest_duration_s(const std::vector<Workspace>& recordings) {
  double duration_s = 0;
  for (const Workspace& at : recordings) {
    duration_s = std::max(duration_s, static_cast<double>(at.sample_count()) * at.period_s());
  }
  return duration_s;
}

void Workspace::set_model(const RobotDescription& robot) {
  // The mass matrix over time is most of the work, and effects are no part of it.
  const bool same = mass.size() == robot.joints.size() && have_same_bodies(rigid, robot);
  rigid = robot;
  known_effects = robot.effects;
  rigid.effects.clear();
  rigid = as_recorded(rigid);
  if (!same) load_torque = desk::model_torque(rigid, motion);
  const RobotDescription recorded = as_recorded(robot);
  stiff_torque = robot.effects.empty() ? load_torque : desk::model_torque(recorded, motion, bodies);
  model_torque = stiff_torque;
  if (has_transmission_effect(recorded)) {
    model_torque +=
        transmission_torque(recorded, motion, stiff_torque, torque, torque_noise_density, plan);
  }
  if (!same) mass = mass_columns(*this);
}

void Workspace::set_sign_width(const VectorXd& widths) {
  constexpr double kStill = 1e-9;
  sign_width = widths;
  for (Index joint = 0; joint < sign_width.size(); ++joint) {
    if (sign_width[joint] > 0) continue;
    sign_width[joint] = std::max(0.01 * top_speed[joint], kStill);
  }
}

bool Workspace::knows(EffectKind kind, Index joint) const {
  return std::any_of(known_effects.begin(), known_effects.end(), [&](const RobotEffect& effect) {
    return effect.kind == kind && is_of_joint(rigid, effect, joint);
  });
}

bool Workspace::knows_dry_friction(Index joint) const {
  return std::any_of(known_effects.begin(), known_effects.end(), [&](const RobotEffect& effect) {
    return info_of(effect.kind)->traits.part == FrictionPart::kDry &&
           is_of_joint(rigid, effect, joint);
  });
}

Workspace make_workspace(const Log& log, const RobotDescription& robot, const FilterPlan& plan,
                         const VectorXd& sign_width) {
  constexpr double kRatePerCutoff = 20;
  const auto stride = std::max<Index>(
      1, static_cast<Index>(plan.sample_rate_hz / (kRatePerCutoff * plan.torque_cutoff_hz)));
  Workspace at;
  at.file = log.file;
  at.payload = log.payload;
  at.plan = thinned(plan, stride);
  const Motion full = motion_of(log, plan);
  at.motion = {every_nth(full.t_s, stride), every_nth_row(full.q, stride),
               every_nth_row(full.dq, stride), every_nth_row(full.ddq, stride)};
  MatrixXd torque = log.tau;
  MatrixXd moving(at.motion.sample_count(), torque.cols());
  MatrixXd usable = MatrixXd::Ones(log.left_out.empty() ? 0 : moving.rows(), torque.cols());
  at.torque_noise_density.resize(torque.cols());
  for (Index joint = 0; joint < torque.cols(); ++joint) {
    moving.col(joint) = every_nth(samples_that_tell(log, robot, joint, full.dq.col(joint)), stride);
    const VectorXd own = usable_samples(log, plan, joint);
    if (own.size() > 0) usable.col(joint) = every_nth(own, stride);
    at.torque_noise_density[joint] = 0;
    if (log.at_rest) continue;
    const VectorXd raw = log.tau.col(joint);
    const VectorXd smooth = zero_phase_low_pass(raw, plan.position_cutoff_hz, plan.sample_rate_hz);
    at.torque_noise_density[joint] = noise_density(raw, smooth, own, plan);
    if (stride > 1) torque.col(joint) = smooth;
  }
  at.torque = every_nth_row(torque, stride);
  at.start_s = log.t_s[0];
  at.at_rest = log.at_rest;
  at.approach = log.approach;
  at.skew_s = log.period_s;
  for (std::size_t joint = 0; joint < robot.joints.size(); ++joint) {
    at.of_sensor.push_back(log.of_sensor(joint) ? 1 : 0);
  }
  at.set_model(robot);
  at.top_speed = VectorXd::Zero(log.q.cols());
  for (Index joint = 0; joint < log.q.cols(); ++joint) {
    at.top_speed[joint] = quantile(at.motion.dq.col(joint).cwiseAbs(), kTopSpeedShare);
  }
  at.set_sign_width(sign_width);
  if (moving.minCoeff() < 1) at.moving = std::move(moving);
  if (usable.rows() > 0) at.usable = std::move(usable);
  return at;
}

std::vector<Workspace> make_workspaces(const std::vector<Log>& logs, const RobotDescription& robot,
                                       const FilterPlan& plan, const VectorXd& sign_width) {
  std::vector<Workspace> made;
  for (const Log& log : logs) {
    made.push_back(make_workspace(log, robot, plan_for(log, plan), sign_width));
  }
  return made;
}

}  // namespace offnominal::desk
