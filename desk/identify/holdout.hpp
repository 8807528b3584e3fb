#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/regression.hpp"

namespace offnominal::desk {

// Judges models by data that their fit has not seen: recordings kept apart, or contiguous parts of
// the fitted ones, each predicted by a fit of the others. What it is made with has to outlive it.
class HoldOut {
 public:
  // `apart`: recordings kept apart; null: there are none.
  HoldOut(const Regression& regression, const Data* apart)
      : regression_(regression), apart_(apart) {}

  [[nodiscard]] bool is_apart() const { return apart_ != nullptr; }
  // Stacked as the held-out data are; `fit`: of the terms to all fitted recordings.
  [[nodiscard]] Eigen::VectorXd residual(const std::vector<Term>& terms, const ModelFit& fit) const;
  // Of contiguous parts, also where recordings are kept apart: each part predicted by a fit of the
  // others in which the shapes of the terms are fitted anew.
  [[nodiscard]] Eigen::VectorXd cross_validated_with_shapes(const std::vector<Term>& terms) const;
  // Root mean square per joint of such a residual.
  [[nodiscard]] Eigen::VectorXd rms(const Eigen::VectorXd& residual) const;
  // What such a residual is of.
  [[nodiscard]] const Data& data() const {
    return apart_ != nullptr ? *apart_ : regression_.data();
  }

 private:
  [[nodiscard]] Eigen::VectorXd cross_validated(const std::vector<Term>& terms,
                                                bool with_shapes) const;

  const Regression& regression_;
  const Data* apart_;
};

}  // namespace offnominal::desk
