#include "explain/questions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "explain/find_model.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double weighted_energy(const Data& data, const Term& term, const VectorXd& coefficients,
                       const VectorXd& weights) {
  const MatrixXd columns = columns_of(data, term);
  const VectorXd torque = data.layout.weighted(columns * coefficients, weights);
  return torque.squaredNorm();
}

Shown shown(const Data& data, const std::vector<Term>& terms, std::size_t which,
            const ModelFit& fit, const ModelFit& without) {
  const RowLayout& layout = data.layout;
  const VectorXd& weights = fit.joint_weights;
  const auto energy_of = [&](const VectorXd& residual) {
    return layout.weighted(residual, weights).squaredNorm();
  };
  const auto rows = static_cast<double>(layout.rows());
  Shown result;
  result.torque =
      std::sqrt(weighted_energy(data, terms[which], fit.coefficients[which], weights) / rows);
  result.apart =
      std::sqrt(std::max(0.0, energy_of(without.residual) - energy_of(fit.residual)) / rows);
  return result;
}

double smallest_shown(const Data& data, const ModelFit& at, const Screened& one) {
  // Gain in log-likelihood: a p of 1 % over some thousand places where an effect may be.
  constexpr double kAsked = 10;
  constexpr double kNothing = 1e-3;
  const RowLayout& layout = data.layout;
  const Index joint = one.term.joint;
  const VectorXd torque = columns_of(data, one.term) * one.evidence.coefficients;
  const VectorXd weighted = at.remainder.weighted(torque);
  const double whole = layout.energy(weighted)[joint];
  const double apart = layout.energy(at.remainder.beside_basis(weighted).col(0))[joint];
  if (!(apart > kNothing * kNothing * whole)) return std::numeric_limits<double>::infinity();
  const double share = std::sqrt(apart / whole);
  const double left = layout.rms(at.residual)[joint];
  const double samples = std::max(1.0, at.remainder.independent_samples[joint]);
  const double likely = std::sqrt(std::expm1(2 * kAsked / samples));
  const double relevant = std::sqrt(kRelevantShare / (1 - kRelevantShare));
  return std::max(left * std::max(likely, relevant) / share,
                  kRelevantTorque * layout.rms(data.torque)[joint]);
}

}  // namespace offnominal::desk
