#include "discovery/fit.hpp"

#include <Eigen/QR>
#include <cmath>

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

}  // namespace

BoxedFit boxed_least_squares(const MatrixXd& columns, const VectorXd& target,
                             const std::vector<Box>& boxes) {
  constexpr double kRank = 1e-7;
  const Index count = columns.cols();
  BoxedFit fit;
  fit.x = VectorXd::Zero(count);
  fit.at_bound.assign(static_cast<std::size_t>(count), false);
  while (true) {
    std::vector<Index> free;
    VectorXd rest = target;
    for (Index i = 0; i < count; ++i) {
      if (fit.at_bound[static_cast<std::size_t>(i)]) {
        rest -= columns.col(i) * fit.x[i];
      } else {
        free.push_back(i);
      }
    }
    if (free.empty()) {
      fit.residual = rest;
      fit.basis.resize(columns.rows(), 0);
      return fit;
    }
    const Scaled part = scaled(columns, free);
    Eigen::ColPivHouseholderQR<MatrixXd> qr(part.columns);
    qr.setThreshold(kRank);
    const VectorXd solution = qr.solve(rest).cwiseQuotient(part.length);
    Index worst = -1;
    double worst_excess = 0;
    double worst_end = 0;
    for (std::size_t i = 0; i < free.size(); ++i) {
      const Box& box = boxes[static_cast<std::size_t>(free[i])];
      const double value = solution[static_cast<Index>(i)];
      fit.x[free[i]] = value;
      const double end = value > box.high ? box.high : box.low;
      const double excess = std::max(value - box.high, box.low - value);
      const double relative = excess > 0 ? excess / (box.high - box.low) : 0;
      if (relative > worst_excess) {
        worst = free[i];
        worst_excess = relative;
        worst_end = end;
      }
    }
    if (worst < 0) {
      VectorXd x_free(static_cast<Index>(free.size()));
      for (std::size_t i = 0; i < free.size(); ++i) {
        x_free[static_cast<Index>(i)] =
            solution[static_cast<Index>(i)] * part.length[static_cast<Index>(i)];
      }
      fit.residual = rest - part.columns * x_free;
      fit.basis = qr.householderQ() * MatrixXd::Identity(columns.rows(), qr.rank());
      return fit;
    }
    fit.x[worst] = worst_end;
    fit.at_bound[static_cast<std::size_t>(worst)] = true;
  }
}

}  // namespace offnominal::tools::discovery
