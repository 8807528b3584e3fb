#include "analysis/fit_problem.hpp"

#include <algorithm>
#include <set>

#include "analysis/inverse_model.hpp"

namespace offnominal::tools {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

FitProblem::FitProblem(RobotDescription robot, std::vector<Unknown> unknowns,
                       std::vector<ShapeGroup> groups, const Measurement& measured,
                       std::optional<VectorXd> at)
    : robot_(std::move(robot)),
      unknowns_(std::move(unknowns)),
      groups_(std::move(groups)),
      measured_(measured),
      has_path_(has_path_effect(robot_)) {
  std::set<std::size_t> joints;
  for (const Unknown& unknown : unknowns_) {
    for (const std::size_t joint : joints_of(robot_, unknown)) joints.insert(joint);
  }
  joints_.assign(joints.begin(), joints.end());
  const auto count = static_cast<Index>(unknowns_.size());
  if (has_path_) {
    at_.resize(count);
    for (Index i = 0; i < count; ++i) at_[i] = unknowns_[static_cast<std::size_t>(i)].start;
    if (at) at_ = std::move(*at);
    for (const Unknown& unknown : unknowns_) {
      loads_.push_back(is_load(robot_, unknown)
                           ? regressor_before_path(robot_, unknown, measured_.motion)
                           : std::vector<JointColumn>{});
    }
    at_start_ = rows_about(start_shapes());
    return;
  }
  const MatrixXd known =
      filtered_model_torque(with_values(robot_, unknowns_, VectorXd::Zero(count)), measured_);
  for (const std::size_t joint : joints_) {
    const auto column = static_cast<Index>(joint);
    at_start_.push_back({joint, MatrixXd::Zero(samples(), count),
                         measured_.torque.col(column) - known.col(column)});
  }
  const RobotDescription shaped = with_shapes(robot_, groups_, start_shapes());
  for (std::size_t i = 0; i < unknowns_.size(); ++i) {
    fill(regressor(shaped, unknowns_[i], measured_.motion), i, at_start_);
  }
}

FitProblem FitProblem::about(const VectorXd& at) const {
  return {robot_, unknowns_, groups_, measured_, at};
}

// The model at at_ and the unknowns' columns there: target = measured - model + columns at_.
std::vector<JointRows> FitProblem::rows_about(const std::vector<double>& shapes) const {
  const RobotDescription here = with_shapes(with_values(robot_, unknowns_, at_), groups_, shapes);
  const MatrixXd model = filtered_model_torque(here, measured_);
  std::vector<JointRows> rows;
  for (const std::size_t joint : joints_) {
    const auto column = static_cast<Index>(joint);
    rows.push_back({joint, MatrixXd::Zero(samples(), at_.size()),
                    measured_.torque.col(column) - model.col(column)});
  }
  const ToldTorque told = told_torque(here, measured_.motion);
  for (std::size_t i = 0; i < unknowns_.size(); ++i) {
    const Unknown& unknown = unknowns_[i];
    std::vector<JointColumn> columns = loads_[i];
    if (columns.empty() && is_path_effect(here.effects[unknown.effect].kind)) {
      columns = regressor(here, unknown, measured_.motion);
    } else {
      if (columns.empty()) columns = regressor_before_path(here, unknown, measured_.motion);
      pass_path(here, unknown, told, columns);
    }
    fill(columns, i, rows);
  }
  for (JointRows& joint : rows) joint.target += joint.columns * at_;
  return rows;
}

std::vector<double> FitProblem::start_shapes() const {
  std::vector<double> shapes;
  for (const ShapeGroup& group : groups_) shapes.push_back(group.start);
  return shapes;
}

std::vector<double> FitProblem::shapes_in(const RobotDescription& fitted) const {
  std::vector<double> shapes;
  for (const ShapeGroup& group : groups_) {
    const ShapeMember& member = group.members[0];
    shapes.push_back(fitted.effects[member.effect].parameters[member.parameter]);
  }
  return shapes;
}

std::vector<UnknownPrior> FitProblem::priors() const {
  std::vector<UnknownPrior> priors;
  for (const Unknown& unknown : unknowns_) {
    const double deviation = unknown.prior_deviation;
    priors.push_back(
        {unknown.start, deviation > 0 ? 1 / (deviation * deviation) : 0, unknown.is_new});
  }
  return priors;
}

bool FitProblem::depends_on_shapes(const Unknown& unknown) const {
  if (unknown.kind != Unknown::Kind::kEffectParameter) return false;
  return std::any_of(groups_.begin(), groups_.end(), [&](const ShapeGroup& group) {
    return std::any_of(group.members.begin(), group.members.end(),
                       [&](const ShapeMember& member) { return member.effect == unknown.effect; });
  });
}

void FitProblem::fill(const std::vector<JointColumn>& columns, std::size_t index,
                      std::vector<JointRows>& rows) const {
  for (const JointColumn& column : columns) {
    for (JointRows& joint : rows) {
      if (joint.joint != column.joint) continue;
      joint.columns.col(static_cast<Index>(index)) = filtered(measured_.plan, column.values);
    }
  }
}

std::vector<JointRows> FitProblem::rows(const std::vector<double>& shapes) const {
  if (has_path_) return shapes == start_shapes() ? at_start_ : rows_about(shapes);
  std::vector<JointRows> rows = at_start_;
  const RobotDescription shaped = with_shapes(robot_, groups_, shapes);
  for (std::size_t i = 0; i < unknowns_.size(); ++i) {
    if (!depends_on_shapes(unknowns_[i])) continue;
    fill(regressor(shaped, unknowns_[i], measured_.motion), i, rows);
  }
  return rows;
}

VectorXd residual_of(const JointRows& rows, const VectorXd& x) {
  return rows.target - rows.columns * x;
}

double correlation_samples(const Eigen::Ref<const VectorXd>& signal) {
  constexpr double kNegligible = 0.05;
  const Index n = signal.size();
  const VectorXd centred = signal.array() - signal.mean();
  const double energy = centred.squaredNorm();
  if (!(energy > 0)) return 1;
  double sum = 1;
  for (Index lag = 1; lag < n / 2; ++lag) {
    const double correlation = centred.head(n - lag).dot(centred.tail(n - lag)) / energy;
    if (correlation < kNegligible) break;
    sum += 2 * correlation;
  }
  return sum;
}

std::vector<double> likelihood_weights(const std::vector<JointRows>& rows, const VectorXd& x) {
  std::vector<double> weights;
  for (const JointRows& joint : rows) {
    const VectorXd error = residual_of(joint, x);
    const double variance = error.squaredNorm() / static_cast<double>(error.size());
    // An exact model has no error to weigh by; its torque's rounding is the floor.
    const double floor = 1e-24 * joint.target.squaredNorm() / static_cast<double>(error.size());
    const double weight = 1 / (std::max(variance, floor) * correlation_samples(error));
    weights.push_back(std::isfinite(weight) ? weight : 1);
  }
  return weights;
}

}  // namespace offnominal::tools
