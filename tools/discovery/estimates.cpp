#include "discovery/estimates.hpp"

#include <Eigen/QR>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

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
  return (Search::columns_of(data, above) - Search::columns_of(data, below)) * coefficients /
         (2 * step);
}

// Where one term's numbers stand in the covariance.
struct Place {
  Index first = 0;
  Index linear = 0;
  std::vector<Index> shape;  // -1: not estimated
};

std::vector<Estimate> of_term(const Data& data, const Term& term, const VectorXd& coefficients,
                              const MatrixXd& covariance, const Place& place, double quantile) {
  const JointType type =
      data.recordings[0].rigid.joints[static_cast<std::size_t>(term.joint)].joint.type;
  const auto named = [&](const VectorXd& c, const ShapePoint& shape) {
    return term.effect->parameters(type, c, shape, term.ranges);
  };
  const std::vector<NamedValue> at = named(coefficients, term.shape);
  const Index unknowns = covariance.rows();
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
      const double half = quantile * std::sqrt(std::max(0.0, row.dot(covariance * row)));
      if (std::isfinite(half) && half > 0) {
        estimate.ci95 = {at[i].value - half, at[i].value + half};
      }
    }
    estimates.push_back(estimate);
  }
  return estimates;
}

}  // namespace

std::vector<std::vector<Estimate>> estimates_of(const Search& search,
                                                const std::vector<Term>& terms,
                                                const ModelFit& fit) {
  if (terms.empty()) return {};
  const Data& data = search.data();
  const Search::Design design = search.design(terms);
  std::vector<VectorXd> columns;
  for (Index c = 0; c < design.first[0]; ++c) {
    if (!fit.at_bound[static_cast<std::size_t>(c)]) columns.push_back(design.columns.col(c));
  }
  std::vector<Place> places;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    Place place{static_cast<Index>(columns.size()), design.first[i + 1] - design.first[i], {}};
    for (Index c = design.first[i]; c < design.first[i + 1]; ++c) {
      columns.push_back(design.columns.col(c));
    }
    for (std::size_t axis = 0; axis < terms[i].ranges.size(); ++axis) {
      const ShapeRange& range = terms[i].ranges[axis];
      const bool fixed = range.discrete || (range.grid.size() < 2 && !(range.high > range.low));
      place.shape.push_back(fixed ? -1 : static_cast<Index>(columns.size()));
      if (!fixed) columns.push_back(shape_derivative(data, terms[i], fit.coefficients[i], axis));
    }
    places.push_back(std::move(place));
  }

  MatrixXd weighted(data.layout.rows(), static_cast<Index>(columns.size()));
  for (std::size_t c = 0; c < columns.size(); ++c) {
    weighted.col(static_cast<Index>(c)) = data.layout.weighted(columns[c], fit.joint_weights);
  }
  // A column that does not act has no interval; it must not take the others' along.
  VectorXd length = weighted.colwise().norm().transpose();
  for (Index c = 0; c < length.size(); ++c) {
    if (std::isfinite(length[c]) && length[c] > 0) continue;
    weighted.col(c).setZero();
    length[c] = 1;
  }
  weighted = weighted * length.cwiseInverse().asDiagonal();
  const MatrixXd bread =
      (weighted.transpose() * weighted).completeOrthogonalDecomposition().pseudoInverse();
  const VectorXd residual = data.layout.weighted(fit.residual, fit.joint_weights);
  const RowLayout::Blocks blocks = fit.remainder.blocks;
  MatrixXd scores = MatrixXd::Zero(blocks.count, weighted.cols());
  for (Index row = 0; row < weighted.rows(); ++row) {
    scores.row(blocks.of_row[static_cast<std::size_t>(row)]) += residual[row] * weighted.row(row);
  }
  const double free = static_cast<double>(blocks.count) - static_cast<double>(weighted.cols());
  std::vector<std::vector<Estimate>> all;
  MatrixXd covariance;
  double quantile = 0;
  if (free >= 3) {
    const double small_sample = static_cast<double>(blocks.count) / free;
    covariance = length.cwiseInverse().asDiagonal() *
                 (small_sample * bread * (scores.transpose() * scores) * bread) *
                 length.cwiseInverse().asDiagonal();
    constexpr double kUpper = 0.975;
    quantile = boost::math::quantile(boost::math::students_t(free), kUpper);
  }
  for (std::size_t i = 0; i < terms.size(); ++i) {
    all.push_back(of_term(data, terms[i], fit.coefficients[i], covariance, places[i], quantile));
  }
  return all;
}

}  // namespace offnominal::tools::discovery
