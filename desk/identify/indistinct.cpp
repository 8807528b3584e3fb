#include "identify/indistinct.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

std::vector<ModelNumber> numbers_of(const Regression::Design& design) {
  std::vector<ModelNumber> numbers;
  for (const Index kept : design.kept) {
    numbers.push_back({ModelNumber::Of::kNuisance, static_cast<std::size_t>(kept), 0});
  }
  for (std::size_t i = 0; i + 1 < design.first.size(); ++i) {
    for (Index c = design.first[i]; c < design.first[i + 1]; ++c) {
      numbers.push_back({ModelNumber::Of::kTerm, i, static_cast<std::size_t>(c - design.first[i])});
    }
  }
  return numbers;
}

}  // namespace

std::vector<IndistinctNumber> first_indistinct(const Regression& regression,
                                               const std::vector<Term>& terms,
                                               const ModelFit& fit) {
  const Regression::Design design = regression.design(terms);
  const std::vector<ModelNumber> all = numbers_of(design);
  const RowLayout& layout = regression.data().layout;
  std::vector<ModelNumber> free;
  std::vector<VectorXd> columns;
  std::vector<double> below;  // entry of the prior's row, scaled
  const auto count = static_cast<Index>(all.size());
  for (Index c = 0; c < count; ++c) {
    const Prior& prior = design.priors[static_cast<std::size_t>(c)];
    if (prior.is_held()) continue;
    const ModelNumber& number = all[static_cast<std::size_t>(c)];
    const VectorXd column = layout.weighted(design.columns.col(c), fit.joint_weights);
    const double own = fit.prior_weight / prior.deviation;  // 0: no prior
    const double length = std::hypot(column.norm(), own);
    if (!(length > 0)) {
      // Shapes and skews of a joint that stands still are nobody's concern.
      if (number.of == ModelNumber::Of::kTerm) return {{number, {}}};
      continue;
    }
    free.push_back(number);
    columns.push_back(column / length);
    below.push_back(own / length);
  }
  const auto n = static_cast<Index>(free.size());
  if (n == 0) return {};
  MatrixXd correlation(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index k = 0; k <= i; ++k) {
      const auto at = static_cast<std::size_t>(i);
      const auto other = static_cast<std::size_t>(k);
      double product = columns[at].dot(columns[other]);
      if (i == k) product += below[at] * below[at];
      correlation(i, k) = correlation(k, i) = product;
    }
  }
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(correlation);
  if (eigen.eigenvalues()[0] >= kSmallestSingularValue * kSmallestSingularValue) return {};
  const VectorXd direction = eigen.eigenvectors().col(0).cwiseAbs();
  constexpr double kMemberShare = 0.3;
  IndistinctNumber found;
  std::vector<ModelNumber> members;
  for (Index i = 0; i < n; ++i) {
    if (direction[i] < kMemberShare * direction.maxCoeff()) continue;
    members.push_back(free[static_cast<std::size_t>(i)]);
  }
  // Those of the terms come last.
  found.fixed = members.back();
  members.pop_back();
  found.others = std::move(members);
  return {std::move(found)};
}

}  // namespace offnominal::desk
