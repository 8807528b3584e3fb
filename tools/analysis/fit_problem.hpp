#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "analysis/measurement.hpp"
#include "analysis/normal_equations.hpp"
#include "analysis/shape_group.hpp"
#include "analysis/unknown.hpp"
#include "robot/robot.hpp"

namespace offnominal::tools {

// What is fitted, and to what: torque = known part + sum of unknowns times their columns, where
// some columns depend on shape values. Rows are the joints that any unknown acts on. Path effects
// make the torque a product of unknowns: it is then linear about the values `at`, and a fit is
// repeated about what it has found (is_linear()).
class FitProblem {
 public:
  FitProblem(RobotDescription robot, std::vector<Unknown> unknowns, std::vector<ShapeGroup> groups,
             const Measurement& measured, std::optional<Eigen::VectorXd> at = {});

  [[nodiscard]] const RobotDescription& robot() const { return robot_; }
  [[nodiscard]] const std::vector<Unknown>& unknowns() const { return unknowns_; }
  [[nodiscard]] const std::vector<ShapeGroup>& groups() const { return groups_; }
  [[nodiscard]] const Measurement& measured() const { return measured_; }
  [[nodiscard]] const std::vector<std::size_t>& joints() const { return joints_; }
  [[nodiscard]] Eigen::Index samples() const { return measured_.torque.rows(); }
  // False where the columns depend on the values that they were made at.
  [[nodiscard]] bool is_linear() const { return !has_path_; }
  // The same problem, linear about the unknowns' values `at`.
  [[nodiscard]] FitProblem about(const Eigen::VectorXd& at) const;
  [[nodiscard]] std::vector<double> start_shapes() const;
  // The groups' values in a robot that was fitted.
  [[nodiscard]] std::vector<double> shapes_in(const RobotDescription& fitted) const;
  [[nodiscard]] std::vector<UnknownPrior> priors() const;

  // The regression at one set of shape values, one per group. Every column has passed the filter of
  // the torque after its nonlinearity.
  [[nodiscard]] std::vector<JointRows> rows(const std::vector<double>& shapes) const;

 private:
  [[nodiscard]] bool depends_on_shapes(const Unknown& unknown) const;
  void fill(const std::vector<JointColumn>& columns, std::size_t index,
            std::vector<JointRows>& rows) const;
  [[nodiscard]] std::vector<JointRows> rows_about(const std::vector<double>& shapes) const;

  RobotDescription robot_;
  std::vector<Unknown> unknowns_;
  std::vector<ShapeGroup> groups_;
  const Measurement& measured_;
  std::vector<std::size_t> joints_;
  bool has_path_;
  // Read where has_path_: the values, and the columns of unknowns that are loads, before the path.
  Eigen::VectorXd at_;
  std::vector<std::vector<JointColumn>> loads_;
  std::vector<JointRows> at_start_;
};

// Measured minus model torque of one joint's rows.
Eigen::VectorXd residual_of(const JointRows& rows, const Eigen::VectorXd& x);

// How many samples of a correlated signal carry as much as one independent sample: 1 + 2 sum of its
// autocorrelation up to where that first falls below 0.05. At least 1.
double correlation_samples(const Eigen::Ref<const Eigen::VectorXd>& signal);

// Per row set 1 / (error variance * correlation_samples), so that a weighted squared error is twice
// a negative log-likelihood.
std::vector<double> likelihood_weights(const std::vector<JointRows>& rows,
                                       const Eigen::VectorXd& x);

}  // namespace offnominal::tools
