#include "compare/transmission.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "compare/inverse_model.hpp"
#include "robot/transmission.hpp"
#include "signal/differentiate.hpp"
#include "signal/zero_phase.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

bool acts_in_transmission(const RobotEffect& effect) {
  return info_of(effect.kind)->action == EffectAction::kDisplacement;
}

// What the joint's own acceleration asks of it, per sample.
VectorXd own_inertia(const RobotDescription& rigid, const Motion& motion, const MatrixXd& load,
                     Index joint) {
  Motion faster = motion;
  faster.ddq.col(joint).array() += 1;
  return model_torque(rigid, faster).col(joint) - load.col(joint);
}

}  // namespace

SpringPlace place_of_spring(const RobotDescription& robot, Index index, bool of_motor) {
  if (!of_motor) {
    const VectorXd own = VectorXd::Unit(robot.joint_count(), index);
    return {own, own};
  }
  const MatrixXd inverse = motor_per_joint(*robot.transmission).inverse();
  return {inverse.col(index), inverse.col(index)};
}

Displacement displacement_of(VectorXd x, double period_s) {
  const VectorXd dx = central_difference(x, period_s);
  VectorXd ddx = central_difference(dx, period_s);
  return {std::move(x), dx, std::move(ddx)};
}

MatrixXd torque_of_displacement(const RobotDescription& rigid, const Motion& motion,
                                const MatrixXd& load, const VectorXd& along, const Displacement& by,
                                double scale) {
  Motion behind = motion;
  behind.q -= scale * by.x * along.transpose();
  behind.dq -= scale * by.dx * along.transpose();
  behind.ddq -= scale * by.ddx * along.transpose();
  return (model_torque(rigid, behind) - load) / scale;
}

VectorXd without_noise(const VectorXd& transmitted, double density, const FilterPlan& plan) {
  constexpr double kNoiseShare = 0.1;
  constexpr double kNarrower = 0.85;
  constexpr double kNarrowest = 0.2;
  const double period_s = 1 / plan.sample_rate_hz;
  double band_hz = plan.torque_cutoff_hz;
  while (true) {
    VectorXd smooth = zero_phase_low_pass(transmitted, band_hz, plan.sample_rate_hz);
    const VectorXd curved = central_difference(central_difference(smooth, period_s), period_s);
    const double rms = std::sqrt(curved.squaredNorm() / static_cast<double>(curved.size()));
    // White noise of that density per root hertz, differentiated twice.
    const double noise =
        density * std::sqrt(band_hz / 5) * std::pow(2 * std::numbers::pi * band_hz, 2);
    const double narrower = kNarrower * band_hz;
    if (noise < kNoiseShare * rms || narrower < kNarrowest * plan.torque_cutoff_hz) return smooth;
    band_hz = narrower;
  }
}

VectorXd play_displacement(const Eigen::Ref<const VectorXd>& load,
                           const Eigen::Ref<const VectorXd>& inertia, double width,
                           const FilterPlan& plan) {
  const double half = width / 2;
  const double h = 1 / plan.sample_rate_hz;
  VectorXd x(load.size());
  double position = load[0] >= 0 ? half : -half;
  double velocity = 0;
  for (Index i = 0; i < x.size(); ++i) {
    const double acceleration = load[i] / inertia[i];
    velocity += h * acceleration;
    position += h * velocity;
    if (position >= half || position <= -half) {
      position = std::clamp(position, -half, half);
      velocity = 0;
    }
    x[i] = position;
  }
  return zero_phase_low_pass(x, plan.position_cutoff_hz, plan.sample_rate_hz);
}

double noise_density(const VectorXd& raw, const VectorXd& smooth, const VectorXd& usable,
                     const FilterPlan& plan) {
  const double band_hz = plan.sample_rate_hz / 2 - plan.position_cutoff_hz;
  if (!(band_hz > 0)) return 0;
  VectorXd fast = raw - smooth;
  auto samples = static_cast<double>(fast.size());
  if (usable.size() > 0 && usable.sum() > 0) {
    fast.array() *= usable.array();
    samples = usable.sum();
  }
  return std::sqrt(fast.squaredNorm() / samples / band_hz);
}

bool has_transmission_effect(const RobotDescription& robot) {
  return std::any_of(robot.effects.begin(), robot.effects.end(), acts_in_transmission);
}

MatrixXd transmission_torque(const RobotDescription& robot, const Motion& motion,
                             const MatrixXd& stiff, const MatrixXd& measured,
                             const VectorXd& density, const FilterPlan& plan) {
  RobotDescription rigid = robot;
  // What is carried is moved as the links are.
  std::erase_if(rigid.effects, [](const RobotEffect& effect) {
    return info_of(effect.kind)->action != EffectAction::kPointMass;
  });
  const MatrixXd load = model_torque(rigid, motion);
  const VectorXd told_per_given = told_torque(robot, motion).per_given;
  const double period_s = 1 / plan.sample_rate_hz;
  MatrixXd added = MatrixXd::Zero(stiff.rows(), stiff.cols());
  for (const RobotEffect& effect : robot.effects) {
    if (!acts_in_transmission(effect)) continue;
    const auto joint = static_cast<Index>(effect.joint);
    const SpringPlace place = place_of_spring(robot, joint, effect.of_motor);
    VectorXd x;
    if (effect.kind == EffectKind::kJointElasticity) {
      const VectorXd transmitted = (measured - (stiff - load)) * place.from_torques;
      const double noise = density.cwiseProduct(place.from_torques).norm();
      x = without_noise(transmitted, noise, plan) / effect.parameters[0];
    } else {
      x = play_displacement(load.col(joint), own_inertia(rigid, motion, load, joint),
                            effect.parameters[0], plan);
    }
    added += torque_of_displacement(rigid, motion, load, place.along,
                                    displacement_of(std::move(x), period_s)) *
             told_per_given.asDiagonal();
  }
  return added;
}

}  // namespace offnominal::desk
