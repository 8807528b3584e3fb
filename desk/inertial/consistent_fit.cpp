#include "inertial/consistent_fit.hpp"

#include <ceres/cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr int kTen = static_cast<int>(kInertialNumbers);
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using PointMap = Eigen::Map<const LogCholesky>;

// columns x - target, x from the links' coordinates, a block each, and the linear numbers.
class DataCost : public ceres::CostFunction {
 public:
  DataCost(const ConsistentModel& model, const ReducedRows::Equations& equations)
      : model_(model), equations_(equations) {
    set_num_residuals(static_cast<int>(equations.target.size()));
    mutable_parameter_block_sizes()->assign(model.links.size(), kTen);
    if (model.linear.empty()) return;
    mutable_parameter_block_sizes()->push_back(static_cast<int>(model.linear.size()));
    linear_ = equations.columns(Eigen::all, model.linear);
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    Eigen::Map<VectorXd> residual(residuals, equations_.target.size());
    residual = -equations_.target;
    for (std::size_t i = 0; i < model_.links.size(); ++i) {
      const ConsistentModel::Link& link = model_.links[i];
      const LogCholesky point = PointMap(parameters[i]);
      const auto own = equations_.columns.middleCols(link.first, kInertialNumbers);
      residual += own * (inertial_numbers_at(link.about, point) - link.start);
      if (jacobians == nullptr || jacobians[i] == nullptr) continue;
      Eigen::Map<RowMajor>(jacobians[i], residual.size(), kInertialNumbers) =
          own * inertial_slopes_at(link.about, point);
    }
    if (!model_.linear.empty()) {
      const std::size_t last = model_.links.size();
      residual += linear_ * Eigen::Map<const VectorXd>(parameters[last], linear_.cols());
      if (jacobians != nullptr && jacobians[last] != nullptr) {
        Eigen::Map<RowMajor>(jacobians[last], residual.size(), linear_.cols()) = linear_;
      }
    }
    return residual.allFinite();
  }

 private:
  const ConsistentModel& model_;
  const ReducedRows::Equations& equations_;
  MatrixXd linear_;
};

// weights (x - mean) of one block.
class PriorCost : public ceres::CostFunction {
 public:
  PriorCost(VectorXd weights, VectorXd mean)
      : weights_(std::move(weights)), mean_(std::move(mean)) {
    set_num_residuals(static_cast<int>(mean_.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(mean_.size()));
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const Eigen::Map<const VectorXd> x(parameters[0], mean_.size());
    Eigen::Map<VectorXd>(residuals, mean_.size()) = weights_.cwiseProduct(x - mean_);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<RowMajor>(jacobians[0], mean_.size(), mean_.size()) = weights_.asDiagonal();
    }
    return true;
  }

 private:
  VectorXd weights_;
  VectorXd mean_;
};

void set_ends(const std::vector<Prior>& priors, double* linear, ceres::Problem& problem) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < priors.size(); ++i) {
    const int at = static_cast<int>(i);
    if (priors[i].low > -kNone) problem.SetParameterLowerBound(linear, at, priors[i].low);
    if (priors[i].high < kNone) problem.SetParameterUpperBound(linear, at, priors[i].high);
  }
}

}  // namespace

LogCholesky deviations_of_share(double share) {
  // Mass and second moments go with e^2a and e^2d.
  LogCholesky deviations = LogCholesky::Constant(share);
  deviations.head<4>() *= 0.5;
  return deviations;
}

ConsistentPoint start_of(const ConsistentModel& model) {
  ConsistentPoint point;
  point.links.assign(model.links.size(), LogCholesky::Zero());
  point.linear = VectorXd::Zero(static_cast<Index>(model.linear.size()));
  for (std::size_t i = 0; i < model.priors.size(); ++i) {
    double& value = point.linear[static_cast<Index>(i)];
    value = std::clamp(value, model.priors[i].low, model.priors[i].high);
  }
  return point;
}

VectorXd columns_at(const ConsistentModel& model, const ConsistentPoint& point) {
  VectorXd x = VectorXd::Zero(model.columns);
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const ConsistentModel::Link& link = model.links[i];
    x.segment(link.first, kInertialNumbers) =
        inertial_numbers_at(link.about, point.links[i]) - link.start;
  }
  for (std::size_t i = 0; i < model.linear.size(); ++i) {
    x[model.linear[i]] = point.linear[static_cast<Index>(i)];
  }
  return x;
}

MatrixXd slopes_at(const ConsistentModel& model, const ConsistentPoint& point) {
  const auto of_links = static_cast<Index>(model.links.size()) * kInertialNumbers;
  MatrixXd slopes =
      MatrixXd::Zero(model.columns, of_links + static_cast<Index>(model.linear.size()));
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const ConsistentModel::Link& link = model.links[i];
    slopes.block(link.first, static_cast<Index>(i) * kInertialNumbers, kInertialNumbers,
                 kInertialNumbers) = inertial_slopes_at(link.about, point.links[i]);
  }
  for (std::size_t i = 0; i < model.linear.size(); ++i) {
    slopes(model.linear[i], of_links + static_cast<Index>(i)) = 1;
  }
  return slopes;
}

std::vector<Prior> priors_of(const ConsistentModel& model, double share) {
  const LogCholesky deviations = deviations_of_share(share);
  std::vector<Prior> priors;
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    for (const double deviation : deviations) {
      Prior prior;
      prior.deviation = deviation;
      priors.push_back(prior);
    }
  }
  priors.insert(priors.end(), model.priors.begin(), model.priors.end());
  return priors;
}

ConsistentPoint consistent_fit(const ConsistentModel& model,
                               const ReducedRows::Equations& equations, double share,
                               double prior_weight, const ConsistentPoint& from) {
  ConsistentPoint point = from;
  if (model.links.empty() && model.linear.empty()) return point;
  ceres::Problem problem;
  std::vector<double*> blocks;
  for (LogCholesky& link : point.links) blocks.push_back(link.data());
  if (!model.linear.empty()) blocks.push_back(point.linear.data());
  problem.AddResidualBlock(new DataCost(model, equations), nullptr, blocks);
  const VectorXd of_link = prior_weight * deviations_of_share(share).cwiseInverse();
  for (LogCholesky& link : point.links) {
    problem.AddResidualBlock(new PriorCost(of_link, LogCholesky::Zero()), nullptr, link.data());
  }
  if (!model.linear.empty()) {
    VectorXd weights(point.linear.size());
    VectorXd mean(point.linear.size());
    for (std::size_t i = 0; i < model.priors.size(); ++i) {
      weights[static_cast<Index>(i)] = prior_weight / model.priors[i].deviation;  // 0: no prior
      mean[static_cast<Index>(i)] = model.priors[i].mean;
    }
    problem.AddResidualBlock(new PriorCost(weights, mean), nullptr, point.linear.data());
    set_ends(model.priors, point.linear.data(), problem);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-9;
  options.parameter_tolerance = 1e-10;
  options.gradient_tolerance = 0;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) {
    throw std::runtime_error("the fit of links and drives to the recordings failed: " +
                             summary.message);
  }
  return point;
}

}  // namespace offnominal::desk
