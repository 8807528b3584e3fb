#include "discovery/estimates.hpp"

#include <Eigen/QR>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "discovery/regimes.hpp"
#include "discovery/torque_scale.hpp"

namespace offnominal::tools::discovery {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kStep = 1e-3;  // relative, of a shape

// What a small change of one shape does to the model's torque, per change.
VectorXd shape_derivative(const Data& data, const Term& term, const VectorXd& coefficients,
                          std::size_t axis) {
  const double step = kStep * std::max(std::abs(term.shape[axis]), 1e-9);
  Term above = term;
  Term below = term;
  above.shape[axis] += step;
  below.shape[axis] -= step;
  return (columns_of(data, above) - columns_of(data, below)) * coefficients / (2 * step);
}

struct Covariance {
  MatrixXd matrix;      // of the unknowns
  double quantile = 0;  // of Student's t, two-sided 95 %
};

// Where one term's numbers stand in the covariance.
struct Place {
  Index first = 0;
  Index linear = 0;
  std::vector<Index> shape;  // -1: not estimated
};

// `factor`: from the regression's coefficients to those of a robot file.
std::vector<Estimate> of_term(const Data& data, const Term& term, const VectorXd& coefficients,
                              double factor, const std::vector<Covariance>& covariances,
                              const Place& place) {
  const JointType type = data.recordings[0].joint_type(term.joint);
  const auto named = [&](const VectorXd& c, const ShapePoint& shape) {
    return term.effect->parameters(type, factor * c, shape, term.ranges);
  };
  const std::vector<NamedValue> at = named(coefficients, term.shape);
  const Index unknowns = covariances.empty() ? 0 : covariances[0].matrix.rows();
  MatrixXd slope = MatrixXd::Zero(static_cast<Index>(at.size()), std::max<Index>(unknowns, 1));
  const auto differentiate = [&](Index column, double step, const auto& moved) {
    if (column < 0 || !(step > 0)) return;
    const std::vector<NamedValue> above = moved(step);
    const std::vector<NamedValue> below = moved(-step);
    for (std::size_t i = 0; i < at.size(); ++i) {
      slope(static_cast<Index>(i), column) = (above[i].value - below[i].value) / (2 * step);
    }
  };
  for (Index c = 0; c < place.linear; ++c) {
    differentiate(place.first + c, 1e-4 * std::max(std::abs(coefficients[c]), 1e-12),
                  [&](double by) {
                    VectorXd moved = coefficients;
                    moved[c] += by;
                    return named(moved, term.shape);
                  });
  }
  for (std::size_t axis = 0; axis < place.shape.size(); ++axis) {
    differentiate(place.shape[axis], 1e-4 * std::max(std::abs(term.shape[axis]), 1e-12),
                  [&](double by) {
                    ShapePoint moved = term.shape;
                    moved[axis] += by;
                    return named(coefficients, moved);
                  });
  }
  std::vector<Estimate> estimates;
  for (std::size_t i = 0; i < at.size(); ++i) {
    Estimate estimate{at[i], std::nullopt};
    if (unknowns > 0) {
      const VectorXd row = slope.row(static_cast<Index>(i)).transpose();
      double half = 0;
      for (const Covariance& one : covariances) {
        half = std::max(half, one.quantile * std::sqrt(std::max(0.0, row.dot(one.matrix * row))));
      }
      if (std::isfinite(half) && half > 0) {
        estimate.ci95 = {at[i].value - half, at[i].value + half};
      }
    }
    estimates.push_back(estimate);
  }
  return estimates;
}

// The model about its fit: one column and prior per unknown, nuisance first, shapes included.
struct Linearised {
  std::vector<VectorXd> columns;
  std::vector<Prior> priors;
  std::vector<Place> places;
};

Linearised linearise(const Regression& regression, const std::vector<Term>& terms,
                     const ModelFit& fit) {
  const Regression::Design design = regression.design(terms);
  Linearised model;
  const auto add = [&](VectorXd column, const Prior& prior) {
    model.columns.push_back(std::move(column));
    model.priors.push_back(prior);
  };
  for (Index c = 0; c < design.first[0]; ++c) {
    add(design.columns.col(c), design.priors[static_cast<std::size_t>(c)]);
  }
  for (std::size_t i = 0; i < terms.size(); ++i) {
    Place place{
        static_cast<Index>(model.columns.size()), design.first[i + 1] - design.first[i], {}};
    for (Index c = design.first[i]; c < design.first[i + 1]; ++c) add(design.columns.col(c), {});
    for (std::size_t axis = 0; axis < terms[i].ranges.size(); ++axis) {
      const bool searched = terms[i].ranges[axis].is_searched();
      place.shape.push_back(searched ? static_cast<Index>(model.columns.size()) : -1);
      if (!searched) continue;
      add(shape_derivative(regression.data(), terms[i], fit.coefficients[i], axis), {});
    }
    model.places.push_back(std::move(place));
  }
  return model;
}

// Weighted columns with the rows of the priors below them, each scaled to length 1.
struct ScaledColumns {
  MatrixXd columns;
  VectorXd length;
};

ScaledColumns weighted_columns(const Linearised& model, const RowLayout& layout,
                               const ModelFit& fit) {
  const auto unknowns = static_cast<Index>(model.columns.size());
  ScaledColumns scaled{MatrixXd::Zero(layout.rows() + unknowns, unknowns), VectorXd(unknowns)};
  for (Index c = 0; c < unknowns; ++c) {
    const auto at = static_cast<std::size_t>(c);
    auto column = scaled.columns.col(c);
    column.head(layout.rows()) = layout.weighted(model.columns[at], fit.joint_weights);
    column[layout.rows() + c] = fit.prior_weight / model.priors[at].deviation;  // 0: no prior
    // A column that does not act has no interval; it must not take the others' along.
    if (!std::isfinite(column.norm()) || !(column.norm() > 0)) column.setZero();
    scaled.length[c] = column.norm() > 0 ? column.norm() : 1;
    column /= scaled.length[c];
  }
  return scaled;
}

// Sum over the groups of the outer product of their scores.
MatrixXd meat_of(const RowLayout::Blocks& groups, const MatrixXd& columns,
                 const VectorXd& residual) {
  MatrixXd scores = MatrixXd::Zero(groups.count, columns.cols());
  for (Index row = 0; row < residual.size(); ++row) {
    scores.row(groups.of_row[static_cast<std::size_t>(row)]) += residual[row] * columns.row(row);
  }
  return scores.transpose() * scores;
}

// One covariance that holds for errors that are independent between blocks of time, and one for
// each way to group the samples by what the joint does: a model that is slightly wrong is wrong in
// the same way whenever the joint does the same, and no length of recording averages that out.
std::vector<Covariance> covariances_of(const Linearised& model, const Data& data,
                                       const ModelFit& fit) {
  constexpr double kUpper = 0.975;
  const RowLayout& layout = data.layout;
  const ScaledColumns scaled = weighted_columns(model, layout, fit);
  const RowLayout::Blocks& blocks = fit.remainder.blocks;
  const VectorXd residual = layout.weighted(fit.residual, fit.joint_weights);
  const Index unknowns = scaled.columns.cols();
  // A prior is off by one standard deviation, whatever this one robot shows of it.
  const VectorXd of_priors = fit.prior_weight * fit.prior_weight *
                             scaled.columns.bottomRows(unknowns).diagonal().cwiseAbs2();
  const auto of_recordings = static_cast<double>(blocks.count);
  const auto judged_by_data = static_cast<double>(unknowns - fit.remainder.prior_rows());
  const double free = of_recordings - judged_by_data;
  if (free < 3) return {};
  const MatrixXd bread = (scaled.columns.transpose() * scaled.columns)
                             .completeOrthogonalDecomposition()
                             .pseudoInverse();
  const MatrixXd per_length = scaled.length.cwiseInverse().asDiagonal();
  const auto covariance = [&](const RowLayout::Blocks& groups, double degrees, double correction) {
    MatrixXd meat = meat_of(groups, scaled.columns, residual);
    meat.diagonal() += of_priors;
    return Covariance{per_length * (correction * bread * meat * bread) * per_length,
                      boost::math::quantile(boost::math::students_t(degrees), kUpper)};
  };
  std::vector<Covariance> all{covariance(blocks, free, of_recordings / free)};
  for (const RowLayout::Blocks& regimes : regimes_of(data)) {
    const auto groups = static_cast<double>(regimes.count);
    all.push_back(covariance(regimes, groups - 1, groups / (groups - 1)));
  }
  return all;
}

}  // namespace

std::vector<std::vector<Estimate>> estimates_of(const Regression& regression,
                                                const std::vector<Term>& terms,
                                                const ModelFit& fit) {
  if (terms.empty()) return {};
  const Data& data = regression.data();
  const Linearised model = linearise(regression, terms, fit);
  const std::vector<Covariance> covariances = covariances_of(model, data, fit);
  std::vector<std::vector<Estimate>> all;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const double factor = factor_beside_torque_scale(terms, fit, terms[i]);
    all.push_back(
        of_term(data, terms[i], fit.coefficients[i], factor, covariances, model.places[i]));
  }
  return all;
}

}  // namespace offnominal::tools::discovery
