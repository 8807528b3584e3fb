#include "identify/fit.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "identify/few_rows.hpp"

namespace offnominal::desk {

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
RegressionRows with_prior_rows(const MatrixXd& columns, const VectorXd& target,
                               const std::vector<Prior>& priors, double prior_weight) {
  const auto count = std::count_if(priors.begin(), priors.end(),
                                   [](const Prior& p) { return p.is_informative(); });
  RegressionRows whole{MatrixXd::Zero(columns.rows() + count, columns.cols()),
                       VectorXd::Zero(columns.rows() + count)};
  whole.columns.topRows(columns.rows()) = columns;
  whole.target.head(columns.rows()) = target;
  Index row = columns.rows();
  for (std::size_t i = 0; i < priors.size(); ++i) {
    if (!priors[i].is_informative()) continue;
    const double weight = row_of(priors[i], prior_weight);
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

// Least squares over the unknowns that are still free; the others are held at an end of theirs.
struct Problem {
  MatrixXd columns;
  VectorXd rest;  // what the free ones have to explain
  std::vector<Index> free;
  VectorXd x;

  void hold(const Outside& at) {
    x[at.unknown] = at.end;
    rest -= columns.col(at.unknown) * at.end;
    std::erase(free, at.unknown);
  }
};

struct FreeFit {
  Scaled part;
  RegressionRows few;
  Eigen::ColPivHouseholderQR<MatrixXd> qr;  // of the few rows
  VectorXd scaled_x;

  // What makes an orthonormal basis of the columns that are free; `count`: of all columns.
  [[nodiscard]] MatrixXd to_basis(const std::vector<Index>& free, Index count) const {
    const Index rank = qr.rank();
    MatrixXd in_order = part.length.cwiseInverse().asDiagonal() * MatrixXd(qr.colsPermutation());
    in_order.conservativeResize(Eigen::NoChange, rank);
    qr.matrixQR()
        .topLeftCorner(rank, rank)
        .triangularView<Eigen::Upper>()
        .solveInPlace<Eigen::OnTheRight>(in_order);
    MatrixXd whole = MatrixXd::Zero(count, rank);
    for (std::size_t i = 0; i < free.size(); ++i) {
      whole.row(free[i]) = in_order.row(static_cast<Index>(i));
    }
    return whole;
  }
};

FreeFit fit_free(Problem& problem) {
  constexpr double kRank = 1e-7;
  FreeFit fit{scaled(problem.columns, problem.free), {}, {}, {}};
  fit.few = few_rows(fit.part.columns, problem.rest);
  fit.qr.setThreshold(kRank);
  fit.qr.compute(fit.few.columns);
  fit.scaled_x = fit.qr.solve(fit.few.target);
  for (std::size_t i = 0; i < problem.free.size(); ++i) {
    const auto at = static_cast<Index>(i);
    problem.x[problem.free[i]] = fit.scaled_x[at] / fit.part.length[at];
  }
  return fit;
}

// The same problem turned so that only as many rows are left as there are unknowns.
Problem turned(const Problem& problem, const FreeFit& fit) {
  const Index rows = std::min(fit.few.columns.rows(), fit.few.columns.cols());
  const MatrixXd upper = fit.qr.matrixQR().topRows(rows).triangularView<Eigen::Upper>();
  const MatrixXd in_order = upper * fit.qr.colsPermutation().inverse();
  VectorXd target = fit.few.target;
  target.applyOnTheLeft(fit.qr.householderQ().adjoint());
  return {in_order * fit.part.length.asDiagonal(), target.head(rows), problem.free, problem.x};
}

// Holds one unknown after the other until none is outside of its ends. Which ones that are is found
// on the turned problem, where a fit costs next to nothing.
FreeFit fit_within_ends(Problem& whole, const std::vector<Prior>& priors) {
  FreeFit fit = fit_free(whole);
  Outside worst = furthest_outside(whole.x, whole.free, priors);
  if (worst.unknown < 0) return fit;
  Problem small = turned(whole, fit);
  while (worst.unknown >= 0 && !whole.free.empty()) {
    whole.hold(worst);
    small.hold(worst);
    if (!small.free.empty()) static_cast<void>(fit_free(small));
    worst = furthest_outside(small.x, small.free, priors);
  }
  while (!whole.free.empty()) {
    fit = fit_free(whole);
    worst = furthest_outside(whole.x, whole.free, priors);
    if (worst.unknown < 0) break;
    whole.hold(worst);
  }
  return fit;
}

}  // namespace

PriorFit least_squares_with_priors(const MatrixXd& columns, const VectorXd& target,
                                   const std::vector<Prior>& priors, double prior_weight) {
  RegressionRows rows = with_prior_rows(columns, target, priors, prior_weight);
  Problem whole{
      std::move(rows.columns), std::move(rows.target), {}, VectorXd::Zero(columns.cols())};
  whole.free.resize(static_cast<std::size_t>(columns.cols()));
  std::iota(whole.free.begin(), whole.free.end(), 0);
  PriorFit result;
  result.residual = whole.rest;
  result.to_basis.resize(columns.cols(), 0);
  if (!whole.free.empty()) {
    const FreeFit fit = fit_within_ends(whole, priors);
    result.residual = whole.rest;
    if (!whole.free.empty()) {
      result.residual -= fit.part.columns * fit.scaled_x;
      result.to_basis = fit.to_basis(whole.free, columns.cols());
    }
  }
  result.basis = whole.columns * result.to_basis;
  result.x = whole.x;
  for (std::size_t i = 0; i < priors.size(); ++i) {
    const Prior& prior = priors[i];
    if (prior.is_one_value()) result.x[static_cast<Index>(i)] = (prior.low + prior.high) / 2;
  }
  return result;
}

ProfileFit::ProfileFit(const MatrixXd& columns, const VectorXd& target, std::vector<Prior> priors,
                       double prior_weight)
    : priors_(std::move(priors)), prior_weight_(prior_weight) {
  const Eigen::HouseholderQR<MatrixXd> qr(columns);
  const Index rank = std::min(columns.rows(), columns.cols());
  basis_ = qr.householderQ() * MatrixXd::Identity(columns.rows(), rank);
  upper_ = qr.matrixQR().topRows(rank).triangularView<Eigen::Upper>();
  along_ = basis_.transpose() * target;
  beside_ = target - basis_ * along_;
}

ProfileFit::Whole ProfileFit::fitted_with(const MatrixXd& more) const {
  const MatrixXd along = basis_.transpose() * more;
  const MatrixXd rest = more - basis_ * along;
  const Eigen::HouseholderQR<MatrixXd> qr(rest);
  const Index own = upper_.rows();
  const Index added = more.cols();
  MatrixXd columns = MatrixXd::Zero(own + added, upper_.cols() + added);
  columns.topLeftCorner(own, upper_.cols()) = upper_;
  columns.topRightCorner(own, added) = along;
  columns.bottomRightCorner(added, added) =
      qr.matrixQR().topRows(added).triangularView<Eigen::Upper>();
  VectorXd turned = beside_;
  turned.applyOnTheLeft(qr.householderQ().adjoint());
  VectorXd target(own + added);
  target << along_, turned.head(added);
  std::vector<Prior> priors = priors_;
  priors.resize(priors.size() + static_cast<std::size_t>(added));
  return {least_squares_with_priors(columns, target, priors, prior_weight_),
          turned.tail(turned.size() - added).squaredNorm()};
}

double ProfileFit::energy_with(const MatrixXd& more) const {
  const Whole whole = fitted_with(more);
  return whole.fit.residual.squaredNorm() + whole.energy_beside;
}

VectorXd ProfileFit::unknowns_of(const MatrixXd& more) const {
  return fitted_with(more).fit.x.tail(more.cols());
}

}  // namespace offnominal::desk
