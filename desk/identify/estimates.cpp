#include "identify/estimates.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>

#include "identify/combinations.hpp"
#include "identify/freedom.hpp"
#include "identify/regimes.hpp"
#include "identify/sign_width.hpp"
#include "identify/torque_scale.hpp"

namespace offnominal::desk {

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

// What groups of samples show of how far the unknowns may be off.
struct Covariance {
  MatrixXd matrix;  // of the unknowns, as if the groups were many
  std::vector<Freedom> of_joint;
};

// Where one term's numbers stand among the unknowns.
struct Place {
  Index first = 0;
  Index linear = 0;
  std::vector<Index> shape;  // -1: not estimated
  Index joint = 0;           // that shows most of the term
};

// How each of a term's numbers changes with the unknowns; one row per number.
MatrixXd slopes_of(const Term& term, const VectorXd& coefficients, const Place& place,
                   Index unknowns, const auto& named) {
  const auto numbers = static_cast<Index>(named(coefficients, term.shape).size());
  MatrixXd slope = MatrixXd::Zero(numbers, unknowns);
  const auto differentiate = [&](Index column, double step, const auto& moved) {
    if (column < 0 || !(step > 0)) return;
    const std::vector<NamedValue> above = moved(step);
    const std::vector<NamedValue> below = moved(-step);
    for (Index i = 0; i < numbers; ++i) {
      const auto at = static_cast<std::size_t>(i);
      slope(i, column) = (above[at].value - below[at].value) / (2 * step);
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
  return slope;
}

// The widest that any way to group the samples asks for.
void set_interval(const VectorXd& slope, const std::vector<Covariance>& covariances, Index joint,
                  Estimate& estimate) {
  const auto of = static_cast<std::size_t>(joint);
  double half = 0;
  for (const Covariance& one : covariances) {
    const Freedom& freedom = one.of_joint[of];
    if (!freedom.suffices()) {
      estimate.why_no_interval = words_of_too_few(freedom, of);
      return;
    }
    const double deviation = std::sqrt(std::max(0.0, slope.dot(one.matrix * slope)));
    half = std::max(half, half_width_per_deviation(freedom) * deviation);
  }
  if (std::isfinite(half) && half > 0) {
    estimate.ci95 = {estimate.value.value - half, estimate.value.value + half};
  } else {
    estimate.why_no_interval = "no interval: the recordings do not determine it";
  }
}

// How much wider the 95 % region of so many numbers together is than that of one.
double region_over_interval(Index numbers) {
  const auto of = [](double count) {
    return boost::math::quantile(boost::math::chi_squared(count), 0.95);
  };
  return std::sqrt(of(static_cast<double>(numbers)) / of(1));
}

// How linear_numbers() change with all unknowns; one row per number.
MatrixXd slopes_of_linear(const Term& term, const VectorXd& coefficients, const Place& place,
                          Index unknowns) {
  const Index count = linear_numbers(term, coefficients).size();
  MatrixXd slopes = MatrixXd::Zero(count, unknowns);
  slopes.block(0, place.first, place.linear, place.linear).setIdentity();
  Index row = place.linear;
  for (std::size_t axis = 0; row < count; ++axis) {
    if (place.shape[axis] < 0) continue;
    slopes(row, place.first) = term.shape[axis];
    slopes(row++, place.shape[axis]) = coefficients[0];
  }
  return slopes;
}

// Of the ways to group the samples the one that is least sure of the term.
LinearPart linear_part(const Term& term, const VectorXd& coefficients,
                       const std::vector<Covariance>& covariances, const Place& place) {
  const VectorXd value = linear_numbers(term, coefficients);
  LinearPart least{value, {}};
  for (const Covariance& one : covariances) {
    const Freedom& freedom = one.of_joint[static_cast<std::size_t>(place.joint)];
    if (!freedom.suffices()) return {value, {}};
    const double width = half_width_per_deviation(freedom) * region_over_interval(value.size());
    const MatrixXd slopes = slopes_of_linear(term, coefficients, place, one.matrix.rows());
    const LinearPart part{value, width * width * slopes * one.matrix * slopes.transpose()};
    if (least.region.size() == 0 || part.from_nothing() < least.from_nothing()) least = part;
  }
  return least;
}

// Chosen among a few values, or the only one there is: no interval belongs to it.
bool is_chosen(const Term& term, const std::string& number) {
  return std::any_of(term.ranges.begin(), term.ranges.end(), [&](const ShapeRange& range) {
    return range.name == number && !range.is_searched();
  });
}

// `factor`: from the regression's coefficients to those of a robot file.
std::vector<Estimate> of_term(const Data& data, const Term& term, const VectorXd& coefficients,
                              double factor, const std::vector<Covariance>& covariances,
                              const Place& place) {
  const JointType type = data.recordings[0].joint_type(term.joint);
  const auto named = [&](const VectorXd& c, const ShapePoint& shape) {
    return term.effect->parameters(type, factor * c, shape);
  };
  const MatrixXd slope =
      slopes_of(term, coefficients, place, covariances.front().matrix.rows(), named);
  std::vector<Estimate> estimates;
  for (NamedValue& value : named(coefficients, term.shape)) {
    const auto row = static_cast<Index>(estimates.size());
    Estimate estimate{std::move(value), std::nullopt};
    if (is_chosen(term, estimate.value.name)) {
      estimate.why_no_interval = "no interval: chosen, not measured";
    } else {
      set_interval(slope.row(row).transpose(), covariances, place.joint, estimate);
    }
    estimates.push_back(std::move(estimate));
  }
  return estimates;
}

// The model about its fit: one column and prior per unknown, nuisance first, shapes included.
struct Linearised {
  std::vector<VectorXd> columns;
  std::vector<Prior> priors;
  std::vector<Place> places;
  std::vector<Index> nuisance;  // column of every nuisance term; -1: not in the model
  std::vector<Index> widths;
};

Linearised linearise(const Regression& regression, const RobotDescription& robot,
                     const std::vector<Term>& terms, const ModelFit& fit,
                     const std::vector<Index>& widths) {
  const Regression::Design design = regression.design(terms);
  Linearised model;
  const auto add = [&](VectorXd column, const Prior& prior) {
    model.columns.push_back(std::move(column));
    model.priors.push_back(prior);
  };
  model.nuisance.assign(regression.data().nuisance.terms.size(), -1);
  for (Index c = 0; c < design.first[0]; ++c) {
    add(design.columns.col(c), design.priors[static_cast<std::size_t>(c)]);
    model.nuisance[static_cast<std::size_t>(design.kept[static_cast<std::size_t>(c)])] = c;
  }
  for (std::size_t i = 0; i < terms.size(); ++i) {
    Place place{
        static_cast<Index>(model.columns.size()), design.first[i + 1] - design.first[i], {}, 0};
    for (Index c = design.first[i]; c < design.first[i + 1]; ++c) {
      add(design.columns.col(c), design.priors[static_cast<std::size_t>(c)]);
    }
    for (std::size_t axis = 0; axis < terms[i].ranges.size(); ++axis) {
      const bool searched = terms[i].ranges[axis].is_searched();
      place.shape.push_back(searched ? static_cast<Index>(model.columns.size()) : -1);
      if (!searched) continue;
      add(shape_derivative(regression.data(), terms[i], fit.coefficients[i], axis), {});
    }
    model.places.push_back(std::move(place));
  }
  for (const Index joint : widths) {
    model.widths.push_back(static_cast<Index>(model.columns.size()));
    add(width_derivative(regression.data(), robot, terms, fit, joint), {});
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
    if (model.priors[at].is_held()) column.setZero();
    scaled.length[c] = column.norm() > 0 ? column.norm() : 1;
    column /= scaled.length[c];
  }
  return scaled;
}

// Sum over the groups of the outer product of their scores.
MatrixXd meat_of(const RowLayout::Blocks& groups, const MatrixXd& columns,
                 const VectorXd& residual) {
  if (groups.count == 0) return MatrixXd::Zero(columns.cols(), columns.cols());
  MatrixXd scores = MatrixXd::Zero(groups.count, columns.cols());
  for (Index row = 0; row < residual.size(); ++row) {
    scores.row(groups.of_row[static_cast<std::size_t>(row)]) += residual[row] * columns.row(row);
  }
  return scores.transpose() * scores;
}

// Of each joint: the groups that tell of it, and the unknowns that act on it and that nobody knew
// anything of before.
std::vector<Freedom> freedom_of_joints(const Linearised& model, const RowLayout& layout,
                                       const ScaledColumns& scaled,
                                       const RowLayout::Blocks& groups) {
  std::vector<Freedom> of_joint;
  for (const int count : layout.groups_of_joints(groups)) of_joint.push_back({count, 0});
  for (std::size_t c = 0; c < model.columns.size(); ++c) {
    if (model.priors[c].is_informative()) continue;
    const VectorXd energy = layout.energy(scaled.columns.col(static_cast<Index>(c)));
    for (std::size_t joint = 0; joint < of_joint.size(); ++joint) {
      of_joint[joint].unknowns += energy[static_cast<Index>(joint)] > 0;
    }
  }
  return of_joint;
}

// One covariance that holds for errors that are independent between blocks of time, and one for
// each way to group the samples by what the joint does: a model that is slightly wrong is wrong in
// the same way whenever the joint does the same, and no length of recording averages that out.
std::vector<Covariance> covariances_of(const Linearised& model, const ScaledColumns& scaled,
                                       const Data& data, const ModelFit& fit) {
  const RowLayout& layout = data.layout;
  const VectorXd residual = layout.weighted(fit.residual, fit.joint_weights);
  const Index unknowns = scaled.columns.cols();
  // A prior is off by one standard deviation, whatever this one robot shows of it.
  const VectorXd of_priors = fit.prior_weight * fit.prior_weight *
                             scaled.columns.bottomRows(unknowns).diagonal().cwiseAbs2();
  const MatrixXd bread = (scaled.columns.transpose() * scaled.columns)
                             .completeOrthogonalDecomposition()
                             .pseudoInverse();
  const MatrixXd per_length = scaled.length.cwiseInverse().asDiagonal();
  const auto covariance = [&](const RowLayout::Blocks& groups, std::vector<Freedom> of_joint) {
    MatrixXd meat = meat_of(groups, scaled.columns, residual);
    meat.diagonal() += of_priors;
    return Covariance{per_length * (bread * meat * bread) * per_length, std::move(of_joint)};
  };
  const RowLayout::Blocks& blocks = fit.remainder.blocks;
  std::vector<Covariance> all{covariance(blocks, freedom_of_joints(model, layout, scaled, blocks))};
  for (const RowLayout::Blocks& regimes : regimes_of(data)) {
    // So few cannot pay for every number of the fit too: one is taken off, as for a mean.
    std::vector<Freedom> of_joint;
    for (const int count : layout.groups_of_joints(regimes)) of_joint.push_back({count, 1});
    all.push_back(covariance(regimes, std::move(of_joint)));
  }
  return all;
}

// The joint on which most of a term's linear columns is seen.
Index joint_shown_on(const RowLayout& layout, const ScaledColumns& scaled, const Place& place) {
  VectorXd energy = VectorXd::Zero(layout.joint_count());
  for (Index c = 0; c < place.linear; ++c) {
    energy += layout.energy(scaled.columns.col(place.first + c));
  }
  Index joint = 0;
  energy.maxCoeff(&joint);
  return joint;
}

}  // namespace

double LinearPart::from_nothing() const { return from_line(VectorXd::Zero(value.size())); }

double LinearPart::from_line(const VectorXd& line) const {
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  if (region.size() == 0) return kUnknown;
  const Eigen::CompleteOrthogonalDecomposition<MatrixXd> inverse(region);
  const VectorXd weighted = inverse.solve(value);
  double squared = value.dot(weighted);
  const double along = line.dot(inverse.solve(line));
  if (along > 0) squared -= line.dot(weighted) * line.dot(weighted) / along;
  return std::isfinite(squared) ? std::sqrt(std::max(0.0, squared)) : kUnknown;
}

void LinearPart::widen(const VectorXd& deviation) {
  constexpr double kTwoSided95 = 1.96;
  if (region.size() == 0 || !deviation.allFinite()) return;
  const double width = kTwoSided95 * region_over_interval(value.size());
  region += width * width * deviation * deviation.transpose();
}

VectorXd linear_numbers(const Term& term, const VectorXd& coefficients) {
  if (!term.effect->is_mass()) return coefficients;
  std::vector<double> numbers(coefficients.begin(), coefficients.end());
  for (std::size_t axis = 0; axis < term.ranges.size(); ++axis) {
    if (term.ranges[axis].is_searched()) numbers.push_back(coefficients[0] * term.shape[axis]);
  }
  return Eigen::Map<const VectorXd>(numbers.data(), static_cast<Index>(numbers.size()));
}

Estimates estimates_of(const Regression& regression, const RobotDescription& robot,
                       const std::vector<Term>& terms, const ModelFit& fit,
                       const std::vector<Index>& widths) {
  const Data& data = regression.data();
  Linearised model = linearise(regression, robot, terms, fit, widths);
  if (model.columns.empty()) return {};
  const ScaledColumns scaled = weighted_columns(model, data.layout, fit);
  for (Place& place : model.places) place.joint = joint_shown_on(data.layout, scaled, place);
  const std::vector<Covariance> covariances = covariances_of(model, scaled, data, fit);
  Estimates all;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const double factor = factor_of_term(data, terms, fit, i);
    all.terms.push_back(
        of_term(data, terms[i], fit.coefficients[i], factor, covariances, model.places[i]));
    all.linear.push_back(linear_part(terms[i], fit.coefficients[i], covariances, model.places[i]));
  }
  const auto of_column = [&](Index column, double value, Index joint) {
    Estimate estimate{{"", value, ""}, std::nullopt};
    const Index unknowns = scaled.columns.cols();
    if (column >= 0) {
      set_interval(VectorXd::Unit(unknowns, column), covariances, joint, estimate);
    }
    return estimate;
  };
  for (std::size_t i = 0; i < data.nuisance.terms.size(); ++i) {
    all.nuisance.push_back(of_column(model.nuisance[i], fit.nuisance[static_cast<Index>(i)],
                                     data.nuisance.terms[i].joint));
  }
  for (std::size_t i = 0; i < widths.size(); ++i) {
    all.widths.push_back(
        of_column(model.widths[i], data.recordings[0].sign_width[widths[i]], widths[i]));
  }
  // One width per joint: the same number of every term that follows it.
  for (std::size_t i = 0; i < terms.size(); ++i) {
    for (Estimate& one : all.terms[i]) {
      if (one.value.name != effects::kSmoothing.name) continue;
      for (std::size_t w = 0; w < widths.size(); ++w) {
        if (followed_joint(terms[i]) != widths[w]) continue;
        one.ci95 = all.widths[w].ci95;
        one.why_no_interval = all.widths[w].why_no_interval;
      }
    }
  }
  return all;
}

std::vector<Estimate> estimates_of(const Data& data, const ModelFit& fit, const LinearModel& model,
                                   const std::vector<Combination>& combinations) {
  std::vector<Estimate> all;
  Linearised linear;
  linear.columns = model.columns;
  linear.priors = model.priors;
  if (linear.columns.empty()) return std::vector<Estimate>(combinations.size());
  const ScaledColumns scaled = weighted_columns(linear, data.layout, fit);
  const std::vector<Covariance> covariances = covariances_of(linear, scaled, data, fit);
  for (const Combination& one : combinations) {
    Estimate estimate{{"", one.value, ""}, std::nullopt};
    set_interval(one.of_unknowns, covariances, one.joint, estimate);
    all.push_back(std::move(estimate));
  }
  return all;
}

}  // namespace offnominal::desk
