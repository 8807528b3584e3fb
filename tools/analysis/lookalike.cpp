#include "analysis/lookalike.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "analysis/inverse_model.hpp"

namespace offnominal::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSmallestSine = 0.07;
// Less than this share left after the other columns are taken out: nothing to compare.
constexpr double kNothingLeft = 1e-6;

VectorXd without(const MatrixXd& others, const VectorXd& column) {
  if (others.cols() == 0) return column;
  return column - others * others.colPivHouseholderQr().solve(column);
}

bool is_in_model(const RobotDescription& robot, EffectKind kind, std::size_t joint) {
  return std::any_of(robot.effects.begin(), robot.effects.end(), [&](const RobotEffect& effect) {
    return effect.kind == kind && effect.joint == joint;
  });
}

bool needs_a_shape(const EffectInfo& info) {
  return std::any_of(info.parameters.begin(), info.parameters.end(), [](const ParameterInfo& p) {
    return p.role == ParameterRole::kShape && p.required;
  });
}

// The effect on the joint with default shape values, the width of the sign as the model has it.
RobotEffect candidate(const RobotDescription& robot, const EffectInfo& info, std::size_t joint) {
  RobotEffect effect;
  effect.kind = info.kind;
  effect.joint = static_cast<std::uint8_t>(joint);
  for (std::size_t i = 0; i < info.parameters.size(); ++i) {
    if (info.parameters[i].role == ParameterRole::kLinear) continue;
    effect.parameters[i] = info.parameters[i].default_value;
    for (const RobotEffect& known : robot.effects) {
      const auto parameters = info_of(known.kind)->parameters;
      for (std::size_t k = 0; k < parameters.size(); ++k) {
        const bool same =
            known.joint == joint && std::string(parameters[k].name) == info.parameters[i].name;
        if (same) effect.parameters[i] = known.parameters[k];
      }
    }
  }
  return effect;
}

}  // namespace

std::vector<Lookalike> lookalikes(const FitProblem& problem, const Fit& fit) {
  std::vector<Lookalike> found;
  const std::vector<JointRows> rows = problem.rows(problem.shapes_in(fit.robot));
  for (std::size_t i = 0; i < problem.unknowns().size(); ++i) {
    const Unknown& unknown = problem.unknowns()[i];
    const bool was_fitted = std::any_of(
        fit.parameters.begin(), fit.parameters.end(), [&](const FittedParameter& parameter) {
          return parameter.fitted && parameter.effect == unknown.effect &&
                 parameter.parameter == unknown.parameter;
        });
    if (!unknown.is_new || !was_fitted) continue;
    const auto of_joint = std::find_if(rows.begin(), rows.end(), [&](const JointRows& joint) {
      return joint.joint == unknown.joint;
    });
    MatrixXd others(problem.samples(), 0);
    for (Index column = 0; column < of_joint->columns.cols(); ++column) {
      if (column == static_cast<Index>(i)) continue;
      others.conservativeResize(Eigen::NoChange, others.cols() + 1);
      others.rightCols(1) = of_joint->columns.col(column);
    }
    const VectorXd own = without(others, of_joint->columns.col(static_cast<Index>(i)));
    for (const EffectInfo& info : kAllEffectInfos) {
      const bool on_own_joint = is_torque_effect(info.kind) || is_path_effect(info.kind);
      if (!on_own_joint || needs_a_shape(info) ||
          is_in_model(fit.robot, info.kind, unknown.joint)) {
        continue;
      }
      RobotDescription robot = fit.robot;
      robot.effects.push_back(candidate(robot, info, unknown.joint));
      for (const Unknown& other : unknowns_of_effect(robot, robot.effects.size() - 1, false)) {
        const VectorXd raw = filtered(problem.measured().plan,
                                      regressor(robot, other, problem.measured().motion)[0].values);
        const VectorXd its = without(others, raw);
        if (!(its.norm() > kNothingLeft * raw.norm()) || !(own.norm() > 0)) continue;
        const double cosine = std::abs(own.dot(its)) / (own.norm() * its.norm());
        if (1 - cosine * cosine > kSmallestSine * kSmallestSine) continue;
        found.push_back({unknown, info.kind, info.parameters[other.parameter].name});
      }
    }
  }
  return found;
}

}  // namespace offnominal::tools
