#include "analysis/fit_problem.hpp"

#include <algorithm>
#include <set>

namespace offnominal::tools {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

FitProblem::FitProblem(RobotDescription robot, std::vector<Unknown> unknowns,
                       std::vector<ShapeGroup> groups, const Measurement& measured)
    : robot_(std::move(robot)),
      unknowns_(std::move(unknowns)),
      groups_(std::move(groups)),
      measured_(measured) {
  std::set<std::size_t> joints;
  for (const Unknown& unknown : unknowns_) {
    for (const std::size_t joint : joints_of(robot_, unknown)) joints.insert(joint);
  }
  joints_.assign(joints.begin(), joints.end());
  const auto count = static_cast<Index>(unknowns_.size());
  const MatrixXd known =
      filtered_model_torque(with_values(robot_, unknowns_, VectorXd::Zero(count)), measured_);
  for (const std::size_t joint : joints_) {
    const auto column = static_cast<Index>(joint);
    at_start_.push_back({joint, MatrixXd::Zero(samples(), count),
                         measured_.torque.col(column) - known.col(column)});
  }
  const RobotDescription shaped = with_shapes(robot_, groups_, start_shapes());
  for (std::size_t i = 0; i < unknowns_.size(); ++i) fill(shaped, i, at_start_);
}

std::vector<double> FitProblem::start_shapes() const {
  std::vector<double> shapes;
  for (const ShapeGroup& group : groups_) shapes.push_back(group.start);
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

void FitProblem::fill(const RobotDescription& robot, std::size_t index,
                      std::vector<JointRows>& rows) const {
  for (const JointColumn& column : regressor(robot, unknowns_[index], measured_.motion)) {
    for (JointRows& joint : rows) {
      if (joint.joint != column.joint) continue;
      joint.columns.col(static_cast<Index>(index)) = filtered(measured_.plan, column.values);
    }
  }
}

std::vector<JointRows> FitProblem::rows(const std::vector<double>& shapes) const {
  std::vector<JointRows> rows = at_start_;
  const RobotDescription shaped = with_shapes(robot_, groups_, shapes);
  for (std::size_t i = 0; i < unknowns_.size(); ++i) {
    if (depends_on_shapes(unknowns_[i])) fill(shaped, i, rows);
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
