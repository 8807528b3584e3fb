#include "discovery/holdout.hpp"

namespace offnominal::tools::discovery {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd residual_on(const Data& other, const std::vector<Term>& terms, const ModelFit& fit) {
  VectorXd residual = other.target - other.nuisance.columns * fit.nuisance;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    residual -= Search::columns_of(other, terms[i]) * fit.coefficients[i];
  }
  return residual;
}

VectorXd cross_validated_residual(const Search& search, const std::vector<Term>& terms) {
  constexpr int kParts = 5;
  constexpr double kBlockS = 2;
  const RowLayout& layout = search.data().layout;
  const RowLayout::Blocks blocks = layout.blocks(kBlockS);
  VectorXd residual(layout.rows());
  for (int part = 0; part < kParts; ++part) {
    std::vector<char> rows(static_cast<std::size_t>(layout.rows()));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      rows[i] = static_cast<char>(blocks.of_row[i] % kParts != part);
    }
    const VectorXd whole = search.fit(terms, rows).residual;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows[i] == 0) residual[static_cast<Index>(i)] = whole[static_cast<Index>(i)];
    }
  }
  return residual;
}

}  // namespace offnominal::tools::discovery
