#include "identify/lookalike.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "identify/add_setup.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kSmallestSine = 0.07;
// Less than this share left after the other columns are taken out: nothing to compare.
constexpr double kNothingLeft = 1e-6;

// Of the effects that act on their own joint alone.
bool may_look_alike(const Data& data, const EffectCandidate& effect, Index joint) {
  const EffectAction action = effect.info().action;
  return action != EffectAction::kPointMass && action != EffectAction::kReflectedInertia &&
         !effect.is_only_screened() && effect.applies_in_any(data.recordings, joint) &&
         effect.shapes(data.recordings, joint).empty();
}

}  // namespace

std::vector<Lookalike> lookalikes(const Regression& regression, const std::vector<Term>& terms,
                                  std::size_t i, std::size_t c) {
  // A curve of any shape looks like every effect of its variable: that is what it is for.
  if (terms[i].effect->info().traits.has_any_shape) return {};
  const Data& data = regression.data();
  const Index joint = terms[i].joint;
  const Regression::Design design = regression.design(terms);
  const VectorXd one = VectorXd::Ones(data.layout.joint_count());
  const auto of_joint = [&](const VectorXd& column) {
    VectorXd weights = VectorXd::Zero(one.size());
    weights[joint] = 1;
    return data.layout.weighted(column, weights);
  };
  const Index own_column = design.first[i] + static_cast<Index>(c);
  MatrixXd others(data.layout.rows(), 0);
  for (Index column = 0; column < design.columns.cols(); ++column) {
    // What has a prior is not free to take a column's place.
    if (column == own_column || design.priors[static_cast<std::size_t>(column)].is_informative()) {
      continue;
    }
    const VectorXd other = of_joint(design.columns.col(column));
    if (!(other.norm() > 0)) continue;
    others.conservativeResize(Eigen::NoChange, others.cols() + 1);
    others.rightCols(1) = other / other.norm();
  }
  // Eigen's decompositions write out of bounds where there is no column.
  Eigen::ColPivHouseholderQR<MatrixXd> qr;
  if (others.cols() > 0) qr.compute(others);
  const auto without = [&](const VectorXd& column) {
    return others.cols() > 0 ? VectorXd(column - others * qr.solve(column)) : column;
  };
  const VectorXd own = without(of_joint(design.columns.col(own_column)));
  std::vector<Lookalike> found;
  if (!(own.norm() > 0)) return found;
  for (const auto& effect : all_candidates()) {
    if (has_effect(data, terms, effect->kind(), joint)) continue;
    if (!may_look_alike(data, *effect, joint)) continue;
    const MatrixXd columns = stacked_columns(data.layout, data.recordings, *effect, joint, {});
    for (Index k = 0; k < columns.cols(); ++k) {
      const VectorXd raw = of_joint(columns.col(k));
      const VectorXd its = without(raw);
      if (!(its.norm() > kNothingLeft * raw.norm())) continue;
      const double cosine = std::abs(own.dot(its)) / (own.norm() * its.norm());
      if (1 - cosine * cosine > kSmallestSine * kSmallestSine) continue;
      const std::size_t parameter = parameter_of_coefficient(*effect, static_cast<std::size_t>(k));
      found.push_back({effect.get(), effect->info().parameters[parameter].name});
    }
  }
  return found;
}

}  // namespace offnominal::desk
