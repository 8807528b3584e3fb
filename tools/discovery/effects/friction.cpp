#include <algorithm>
#include <cmath>

#include "discovery/effects/effects.hpp"

namespace offnominal::tools::discovery {

using Eigen::ArrayXd;
using Eigen::Index;

namespace {

double top_speed(const std::vector<Workspace>& at, Index joint) {
  double speed = 0;
  for (const Workspace& one : at) speed = std::max(speed, one.top_speed[joint]);
  return speed;
}

std::string velocity_unit(const std::vector<Workspace>& at, Index joint) {
  return unit(Quantity::kVelocity, at[0].joint_type(joint));
}
std::string position_unit(const std::vector<Workspace>& at, Index joint) {
  return unit(Quantity::kPosition, at[0].joint_type(joint));
}

class Viscous final : public EffectCandidate {
 public:
  const char* name() const override { return "viscous_friction"; }
  const char* formula() const override { return "coefficient * dq"; }
  const char* words() const override { return "friction proportional to speed"; }
  const char* motion_hint() const override { return "move at several constant speeds"; }
  std::vector<LinearParameter> linear_parameters(JointType type) const override {
    return {{"coefficient", unit(Quantity::kEffortPerVelocity, type)}};
  }
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> /*shape*/) const override {
    return {{{joint, at.motion.dq.col(joint)}}};
  }
  bool is_physical(const Eigen::VectorXd& c) const override { return c[0] > 0; }
};

class Coulomb final : public EffectCandidate {
 public:
  const char* name() const override { return "coulomb_friction"; }
  const char* formula() const override { return "level * tanh(dq / smoothing)"; }
  const char* words() const override { return "dry friction, independent of speed"; }
  const char* motion_hint() const override { return "reverse often at moderate speed"; }
  std::vector<LinearParameter> linear_parameters(JointType type) const override {
    return {{"level", unit(Quantity::kEffort, type)}};
  }
  std::vector<ShapeRange> shapes(const std::vector<Workspace>& at, Index joint) const override {
    const double top = top_speed(at, joint);
    return {{"smoothing", velocity_unit(at, joint), logarithmic_grid(0.001 * top, 0.05 * top),
             ShapeRange::Kind::kLogarithmic}};
  }
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> shape) const override {
    return {{{joint, (at.motion.dq.col(joint).array() / shape[0]).tanh().matrix()}}};
  }
  bool is_physical(const Eigen::VectorXd& c) const override { return c[0] > 0; }
  bool is_dry_friction() const override { return true; }
};

class Quadratic final : public EffectCandidate {
 public:
  const char* name() const override { return "quadratic_friction"; }
  const char* formula() const override { return "coefficient * dq * |dq|"; }
  const char* words() const override { return "drag that grows with the square of speed"; }
  const char* motion_hint() const override { return "use a speed range of more than 3 to 1"; }
  std::vector<LinearParameter> linear_parameters(JointType type) const override {
    return {{"coefficient", unit(Quantity::kEffortPerVelocitySquared, type)}};
  }
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> /*shape*/) const override {
    const ArrayXd dq = at.motion.dq.col(joint).array();
    return {{{joint, (dq * dq.abs()).matrix()}}};
  }
};

class Stribeck final : public EffectCandidate {
 public:
  const char* name() const override { return "stribeck_friction"; }
  const char* formula() const override {
    return "level * exp(-(dq / stribeck_velocity)^2) * tanh(dq / smoothing)";
  }
  const char* words() const override {
    return "extra dry friction near standstill that fades as the joint speeds up";
  }
  const char* motion_hint() const override {
    return "hold at least four low speeds between a third and three times the Stribeck velocity";
  }
  std::vector<LinearParameter> linear_parameters(JointType type) const override {
    return {{"level", unit(Quantity::kEffort, type)}};
  }
  std::vector<ShapeRange> shapes(const std::vector<Workspace>& at, Index joint) const override {
    const double top = top_speed(at, joint);
    return {{"stribeck_velocity", velocity_unit(at, joint),
             logarithmic_grid(0.015 * top, 0.4 * top), ShapeRange::Kind::kLogarithmic}};
  }
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> shape) const override {
    const ArrayXd ratio = at.motion.dq.col(joint).array() / shape[0];
    return {{{joint, ((-ratio.square()).exp() * at.sign(joint)).matrix()}}};
  }
  bool is_physical(const Eigen::VectorXd& c) const override { return c[0] > 0; }
};

class Asymmetry final : public EffectCandidate {
 public:
  const char* name() const override { return "friction_asymmetry"; }
  const char* formula() const override {
    return "level * s^2 + coefficient * dq * s, s = tanh(dq / smoothing)";
  }
  const char* words() const override { return "friction that differs between the two directions"; }
  const char* motion_hint() const override {
    return "move at several speeds in both directions, with rests in between";
  }
  std::vector<LinearParameter> linear_parameters(JointType type) const override {
    return {{"level", unit(Quantity::kEffort, type)},
            {"coefficient", unit(Quantity::kEffortPerVelocity, type)}};
  }
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> /*shape*/) const override {
    const ArrayXd sign = at.sign(joint);
    return {{{joint, sign.square().matrix()}},
            {{joint, (at.motion.dq.col(joint).array() * sign).matrix()}}};
  }
};

class LoadDependent final : public EffectCandidate {
 public:
  const char* name() const override { return "load_dependent_friction"; }
  const char* formula() const override { return "factor * |load torque| * tanh(dq / smoothing)"; }
  const char* words() const override { return "friction that grows with the torque transmitted"; }
  const char* motion_hint() const override {
    return "reverse at poses with little and with much load";
  }
  std::vector<LinearParameter> linear_parameters(JointType /*type*/) const override {
    return {{"factor", "1"}};
  }
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> /*shape*/) const override {
    return {{{joint, (at.load_torque.col(joint).array().abs() * at.sign(joint)).matrix()}}};
  }
  bool is_physical(const Eigen::VectorXd& c) const override { return c[0] > 0; }
};

// P. R. Dahl, AIAA Journal 14(12), 1976, with exponent 1: dz/dq = (1 - z sgn(dq)) / width.
class Hysteresis final : public EffectCandidate {
 public:
  const char* name() const override { return "hysteresis"; }
  const char* formula() const override {
    return "level * z, dz/dq = (1 - z sgn(dq)) / width (Dahl)";
  }
  const char* words() const override {
    return "friction that builds up over a distance after each reversal";
  }
  const char* motion_hint() const override { return "make many small reversals"; }
  std::vector<LinearParameter> linear_parameters(JointType type) const override {
    return {{"level", unit(Quantity::kEffort, type)}};
  }
  std::vector<ShapeRange> shapes(const std::vector<Workspace>& at, Index joint) const override {
    const double range = range_moved(at, joint);
    return {{"width", position_unit(at, joint), logarithmic_grid(0.006 * range, 0.3 * range),
             ShapeRange::Kind::kLogarithmic}};
  }
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> shape) const override {
    return {{{joint, at.dahl_state(joint, shape[0])}}};
  }
  bool is_physical(const Eigen::VectorXd& c) const override { return c[0] > 0; }
};

}  // namespace

void add_friction_effects(Candidates& all) {
  all.push_back(std::make_unique<Viscous>());
  all.push_back(std::make_unique<Coulomb>());
  all.push_back(std::make_unique<Quadratic>());
  all.push_back(std::make_unique<Stribeck>());
  all.push_back(std::make_unique<Asymmetry>());
  all.push_back(std::make_unique<LoadDependent>());
  all.push_back(std::make_unique<Hysteresis>());
}

}  // namespace offnominal::tools::discovery
