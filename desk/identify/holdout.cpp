#include "identify/holdout.hpp"

#include <algorithm>

#include "identify/shape_search.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd HoldOut::residual(const std::vector<Term>& terms, const ModelFit& fit) const {
  if (apart_ == nullptr) return cross_validated(terms, false);
  VectorXd residual = apart_->target - apart_->nuisance.columns * fit.nuisance;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    residual -= columns_of(*apart_, terms[i]) * fit.coefficients[i];
  }
  return residual;
}

VectorXd HoldOut::rms(const VectorXd& residual) const { return data().layout.rms(residual); }

VectorXd HoldOut::cross_validated_with_shapes(const std::vector<Term>& terms) const {
  return cross_validated(terms, true);
}

VectorXd HoldOut::cross_validated(const std::vector<Term>& terms, bool with_shapes) const {
  constexpr int kParts = 5;
  constexpr double kBlockS = 2;
  const RowLayout& layout = regression_.data().layout;
  // Of a short recording every part needs some of it, and the others what it is predicted by.
  double block_s = kBlockS;
  if (!regression_.data().recordings[0].at_rest) {
    double whole_s = 0;
    for (std::size_t r = 0; r < layout.recording_count(); ++r) {
      whole_s += layout.period_s(r) * static_cast<double>(layout.samples(r));
    }
    block_s = std::min(kBlockS, whole_s / (2 * kParts));
  }
  const RowLayout::Blocks blocks = layout.blocks(block_s);
  const bool has_shapes = std::any_of(terms.begin(), terms.end(),
                                      [](const Term& term) { return !term.ranges.empty(); });
  VectorXd residual(layout.rows());
  for (int part = 0; part < kParts; ++part) {
    std::vector<char> rows(static_cast<std::size_t>(layout.rows()));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      rows[i] = static_cast<char>(blocks.of_row[i] % kParts != part);
    }
    std::vector<Term> shaped = terms;
    if (with_shapes && has_shapes) {
      Data others = regression_.data();
      others.layout.leave_out(rows);
      fit_shapes_again(Regression(others), shaped);
    }
    const VectorXd whole = regression_.fit(shaped, rows).residual;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows[i] == 0) residual[static_cast<Index>(i)] = whole[static_cast<Index>(i)];
    }
  }
  return residual;
}

}  // namespace offnominal::desk
