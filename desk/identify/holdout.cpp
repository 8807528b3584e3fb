#include "identify/holdout.hpp"

#include <algorithm>

#include "identify/held_out_parts.hpp"
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
  const RowLayout& layout = regression_.data().layout;
  const std::vector<int> parts = held_out_parts(layout, regression_.data().recordings[0].at_rest);
  const bool has_shapes = std::any_of(terms.begin(), terms.end(),
                                      [](const Term& term) { return !term.ranges.empty(); });
  VectorXd residual(layout.rows());
  for (int part = 0; part < kHeldOutParts; ++part) {
    std::vector<char> rows(static_cast<std::size_t>(layout.rows()));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      rows[i] = static_cast<char>(parts[i] != part);
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
