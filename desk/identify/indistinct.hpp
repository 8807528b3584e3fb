#pragma once

#include <vector>

#include "identify/regression.hpp"

namespace offnominal::desk {

// A number of a model: of its nuisance, or a coefficient of one of its terms.
struct ModelNumber {
  enum class Of { kNuisance, kTerm } of = Of::kNuisance;
  std::size_t which = 0;        // nuisance term or term
  std::size_t coefficient = 0;  // kTerm
};

// A number that the recordings cannot tell from others, and that is to be left where it was.
struct IndistinctNumber {
  ModelNumber fixed;
  std::vector<ModelNumber> others;  // empty: the recordings do not excite it at all
};

// Two columns are told apart where the sine of the angle between them is above about 0.07: the
// smallest singular value of the columns, each scaled to length 1, has to be at least this.
inline constexpr double kSmallestSingularValue = 0.05;

// The first number that a fit of these terms would leave undetermined, beside its priors; none
// where it determines all. Of the numbers that the recordings cannot tell apart it is the last one
// of the terms, or of the nuisance where no term is among them.
std::vector<IndistinctNumber> first_indistinct(const Regression& regression,
                                               const std::vector<Term>& terms, const ModelFit& fit);

}  // namespace offnominal::desk
