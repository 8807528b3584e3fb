#include "discovery/fit.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace offnominal::tools::discovery {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Columns scaled to length 1, so that rank does not depend on units.
struct Scaled {
  MatrixXd columns;
  VectorXd length;
};

Scaled scaled(const MatrixXd& columns, const std::vector<Index>& which) {
  Scaled result{MatrixXd(columns.rows(), static_cast<Index>(which.size())),
                VectorXd(static_cast<Index>(which.size()))};
  for (std::size_t i = 0; i < which.size(); ++i) {
    const auto to = static_cast<Index>(i);
    const double length = columns.col(which[i]).norm();
    result.length[to] = length > 0 ? length : 1;
    result.columns.col(to) = columns.col(which[i]) / result.length[to];
  }
  return result;
}

// The regression with one more row per informative prior.
struct WithPriorRows {
  MatrixXd columns;
  VectorXd target;
};

WithPriorRows with_prior_rows(const MatrixXd& columns, const VectorXd& target,
                              const std::vector<Prior>& priors, double prior_weight) {
  const auto count = std::count_if(priors.begin(), priors.end(),
                                   [](const Prior& p) { return p.is_informative(); });
  WithPriorRows whole{MatrixXd::Zero(columns.rows() + count, columns.cols()),
                      VectorXd::Zero(columns.rows() + count)};
  whole.columns.topRows(columns.rows()) = columns;
  whole.target.head(columns.rows()) = target;
  Index row = columns.rows();
  for (std::size_t i = 0; i < priors.size(); ++i) {
    if (!priors[i].is_informative()) continue;
    const double weight = prior_weight / priors[i].deviation;
    whole.columns(row, static_cast<Index>(i)) = weight;
    whole.target[row++] = weight * priors[i].mean;
  }
  return whole;
}

// The unknown that is furthest outside of its ends, as a share of their distance.
struct Outside {
  Index unknown = -1;
  double end = 0;
};

Outside furthest_outside(const VectorXd& x, const std::vector<Index>& free,
                         const std::vector<Prior>& priors) {
  Outside worst;
  double worst_share = 0;
  for (const Index i : free) {
    const Prior& prior = priors[static_cast<std::size_t>(i)];
    const double excess = std::max(x[i] - prior.high, prior.low - x[i]);
    const double share = excess > 0 ? excess / (prior.high - prior.low) : 0;
    if (share <= worst_share) continue;
    worst_share = share;
    worst = {i, x[i] > prior.high ? prior.high : prior.low};
  }
  return worst;
}

}  // namespace

PriorFit least_squares_with_priors(const MatrixXd& columns, const VectorXd& target,
                                   const std::vector<Prior>& priors, double prior_weight) {
  constexpr double kRank = 1e-7;
  const WithPriorRows whole = with_prior_rows(columns, target, priors, prior_weight);
  PriorFit fit;
  fit.x = VectorXd::Zero(columns.cols());
  std::vector<Index> free(static_cast<std::size_t>(columns.cols()));
  std::iota(free.begin(), free.end(), 0);
  VectorXd rest = whole.target;
  while (!free.empty()) {
    const Scaled part = scaled(whole.columns, free);
    Eigen::ColPivHouseholderQR<MatrixXd> qr(part.columns);
    qr.setThreshold(kRank);
    const VectorXd scaled_x = qr.solve(rest);
    for (std::size_t i = 0; i < free.size(); ++i) {
      const auto at = static_cast<Index>(i);
      fit.x[free[i]] = scaled_x[at] / part.length[at];
    }
    const Outside worst = furthest_outside(fit.x, free, priors);
    if (worst.unknown < 0) {
      fit.residual = rest - part.columns * scaled_x;
      fit.basis = qr.householderQ() * MatrixXd::Identity(whole.columns.rows(), qr.rank());
      return fit;
    }
    fit.x[worst.unknown] = worst.end;
    rest -= whole.columns.col(worst.unknown) * worst.end;
    std::erase(free, worst.unknown);
  }
  fit.residual = rest;
  fit.basis.resize(whole.columns.rows(), 0);
  return fit;
}

}  // namespace offnominal::tools::discovery
