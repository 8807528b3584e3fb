#include "discovery/holdout.hpp"

namespace offnominal::tools::discovery {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd HoldOut::residual(const std::vector<Term>& terms, const ModelFit& fit) const {
  if (apart_ == nullptr) return cross_validated(terms);
  VectorXd residual = apart_->target - apart_->nuisance.columns * fit.nuisance;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    residual -= columns_of(*apart_, terms[i]) * fit.coefficients[i];
  }
  return residual;
}

VectorXd HoldOut::rms(const VectorXd& residual) const { return data().layout.rms(residual); }

VectorXd HoldOut::cross_validated(const std::vector<Term>& terms) const {
  constexpr int kParts = 5;
  constexpr double kBlockS = 2;
  const RowLayout& layout = regression_.data().layout;
  const RowLayout::Blocks blocks = layout.blocks(kBlockS);
  VectorXd residual(layout.rows());
  for (int part = 0; part < kParts; ++part) {
    std::vector<char> rows(static_cast<std::size_t>(layout.rows()));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      rows[i] = static_cast<char>(blocks.of_row[i] % kParts != part);
    }
    const VectorXd whole = regression_.fit(terms, rows).residual;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows[i] == 0) residual[static_cast<Index>(i)] = whole[static_cast<Index>(i)];
    }
  }
  return residual;
}

}  // namespace offnominal::tools::discovery
