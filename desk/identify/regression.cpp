#include "identify/regression.hpp"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <optional>
#include <utility>

#include "identify/few_rows.hpp"
#include "identify/independent_samples.hpp"
#include "identify/torque_scale.hpp"
#include "signal/correlation.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Moves a term's shape, one number after the other, to where gain(term) is largest on its grid.
template <typename Gain>
void jump(Term& term, const Gain& gain) {
  for (std::size_t axis = 0; axis < term.ranges.size(); ++axis) {
    if (!term.ranges[axis].is_searched()) continue;
    double most = gain(term);
    Term trial = term;
    for (const double value : term.ranges[axis].grid) {
      trial.shape[axis] = value;
      const double found = gain(trial);
      if (found <= most) continue;
      most = found;
      term.shape[axis] = value;
    }
  }
}

// Moves a term's shape, one number after the other, within the neighbouring points of its grid to
// where gain(term) is largest.
template <typename Gain>
void climb_once(Term& term, const Gain& gain) {
  for (std::size_t axis = 0; axis < term.ranges.size(); ++axis) {
    const ShapeRange& range = term.ranges[axis];
    if (!range.is_searched()) continue;
    const bool logarithmic = range.kind == ShapeRange::Kind::kLogarithmic;
    const auto coordinate = [&](double value) { return logarithmic ? std::log(value) : value; };
    const auto value_at = [&](double x) { return logarithmic ? std::exp(x) : x; };
    const auto above = std::upper_bound(range.grid.begin(), range.grid.end(), term.shape[axis]);
    const auto place =
        static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, (above - range.grid.begin()) - 1));
    const double low = coordinate(range.grid[place > 0 ? place - 1 : 0]);
    const double high = coordinate(range.grid[std::min(place + 1, range.grid.size() - 1)]);
    const auto gain_at = [&](double x) {
      Term trial = term;
      trial.shape[axis] = value_at(x);
      return gain(trial);
    };
    constexpr int kBits = 22;
    std::uintmax_t most = 40;
    const auto [found, loss] = boost::math::tools::brent_find_minima(
        [&](double x) { return -gain_at(x); }, low, high, kBits, most);
    if (-loss > gain_at(coordinate(term.shape[axis]))) term.shape[axis] = value_at(found);
  }
}

// The same until it is at the top: what is best for one number depends on the others.
template <typename Gain>
void climb(Term& term, const Gain& gain) {
  constexpr double kStill = 1e-4;  // of the gain, that another turn brings
  const auto searched = std::count_if(term.ranges.begin(), term.ranges.end(),
                                      [](const ShapeRange& one) { return one.is_searched(); });
  double most = gain(term);
  for (auto turn = searched; turn > 0; --turn) {
    climb_once(term, gain);
    const double now = gain(term);
    if (!(now - most > kStill * std::abs(most))) return;
    most = now;
  }
}

// What all numbers of a shape would have to change by together: with coefficient a and coefficients
// b of the column's derivatives, the column at shape + b / a fits best, as far as it is linear.
// Climbed one after the other, a mass and its lever would follow each other for ever.
// `solved`: the coefficients of columns beside everything else, none where they add nothing.
template <typename Solved>
std::optional<ShapePoint> slid(const Data& data, const Term& term, const Solved& solved) {
  const MatrixXd here = columns_of(data, term);
  MatrixXd columns(here.rows(), 1 + static_cast<Index>(term.shape.size()));
  columns.col(0) = here.col(0);
  for (std::size_t axis = 0; axis < term.shape.size(); ++axis) {
    const std::vector<double>& grid = term.ranges[axis].grid;
    const double step = 1e-3 * (grid.back() - grid.front());
    Term above = term;
    Term below = term;
    above.shape[axis] += step;
    below.shape[axis] -= step;
    columns.col(1 + static_cast<Index>(axis)) =
        (columns_of(data, above).col(0) - columns_of(data, below).col(0)) / (2 * step);
  }
  const std::optional<VectorXd> coefficients = solved(columns);
  if (!coefficients) return std::nullopt;
  ShapePoint point = term.shape;
  for (std::size_t axis = 0; axis < point.size(); ++axis) {
    const std::vector<double>& grid = term.ranges[axis].grid;
    const double by = (*coefficients)[1 + static_cast<Index>(axis)] / (*coefficients)[0];
    if (!std::isfinite(by)) return std::nullopt;
    point[axis] = std::clamp(point[axis] + by, grid.front(), grid.back());
  }
  return point;
}

// Moves a place, all of whose numbers are looked for and whose effect has one coefficient, to where
// gain(term) is largest, from where it is and from the middle of its ranges.
template <typename Gain, typename Solved>
void slide(const Data& data, Term& term, const Gain& gain, const Solved& solved) {
  const bool is_place =
      term.ranges.size() > 1 &&
      std::all_of(term.ranges.begin(), term.ranges.end(), [](const ShapeRange& one) {
        return one.is_searched() && one.kind == ShapeRange::Kind::kLinear;
      });
  if (!is_place) return;
  constexpr int kMostSteps = 6;
  Term from_middle = term;
  for (std::size_t axis = 0; axis < term.shape.size(); ++axis) {
    const std::vector<double>& grid = term.ranges[axis].grid;
    from_middle.shape[axis] = grid[grid.size() / 2];
  }
  double most = gain(term);
  for (Term trial : {term, from_middle}) {
    for (int step = 0; step < kMostSteps; ++step) {
      const auto point = slid(data, trial, solved);
      if (!point || *point == trial.shape) break;
      trial.shape = *point;
      const double now = gain(trial);
      if (now > most) {
        most = now;
        term.shape = trial.shape;
      }
    }
  }
}

}  // namespace

VectorXd independent_samples_of(const RowLayout& layout, const VectorXd& residual) {
  VectorXd samples = VectorXd::Zero(layout.joint_count());
  const VectorXd moving = layout.while_moving(residual);
  for (std::size_t r = 0; r < layout.recording_count(); ++r) {
    for (Index joint = 0; joint < layout.joint_count(); ++joint) {
      const auto part = moving.segment(layout.begin(r, joint), layout.samples(r));
      samples[joint] += layout.moving_count(r, joint) / correlation_samples(part);
    }
  }
  return samples;
}

double independent_block_s(const RowLayout& layout, const VectorXd& residual, Index joint) {
  constexpr double kFewestBlocks = 20;
  const VectorXd moving = layout.while_moving(residual);
  double whole_s = 0;
  double correlation_s = 0;
  for (std::size_t r = 0; r < layout.recording_count(); ++r) {
    whole_s += layout.period_s(r) * static_cast<double>(layout.samples(r));
    const auto part = moving.segment(layout.begin(r, joint), layout.samples(r));
    correlation_s = std::max(correlation_s, correlation_samples(part) * layout.period_s(r));
  }
  return std::max(kShortestBlockS, std::min(3 * correlation_s, whole_s / kFewestBlocks));
}

bool Regression::has_dry_friction(const std::vector<Term>& terms, Index joint) const {
  return data_.recordings[0].knows_dry_friction(joint) ||
         std::any_of(terms.begin(), terms.end(), [&](const Term& term) {
           return !term.effect->of_motor() && term.joint == joint &&
                  term.effect->info().traits.part == FrictionPart::kDry;
         });
}

bool has_term(const std::vector<Term>& terms, EffectKind kind, Index joint) {
  return std::any_of(terms.begin(), terms.end(), [&](const Term& term) {
    return !term.effect->of_motor() && term.effect->kind() == kind && term.joint == joint;
  });
}

bool has_effect(const Data& data, const std::vector<Term>& terms, EffectKind kind, Index joint) {
  return data.recordings[0].knows(kind, joint) || has_term(terms, kind, joint);
}

Evidence evidence_for(const Judge& judge, const Data& data, const Term& term) {
  const MatrixXd columns = columns_of(data, term);
  Evidence evidence = judge.evidence(columns);
  const Index fewest = term.effect->info().traits.has_any_shape ? 1 : columns.cols();
  for (Index count = columns.cols() - 1; !evidence.usable && count >= fewest; --count) {
    evidence = judge.evidence(MatrixXd(columns.leftCols(count)));
  }
  return evidence;
}

bool takes_place_of(const Term& term, const NuisanceTerm& nuisance) {
  if (term.joint != nuisance.joint || term.effect->of_motor() || term.during) return false;
  if (nuisance.kind == NuisanceTerm::Kind::kConstant) {
    return term.effect->is_torque_constant();
  }
  return nuisance.kind == NuisanceTerm::Kind::kSkew && term.effect->replaces_skew();
}

namespace {

MatrixXd columns_of_all(const Data& data, const Term& term) {
  const bool of_whole_arm = term.effect->is_mass() || term.effect->is_only_screened();
  const auto& all = all_candidates();
  const bool is_common = std::any_of(all.begin(), all.end(), [&](const auto& one) {
    return one.get() == term.effect;  // any other may have values of its own
  });
  const bool is_place = term.effect->kind() == EffectKind::kTipPayload;
  if (is_place || (of_whole_arm && is_common)) {
    return data.cache->columns(data.layout, data.recordings, *term.effect, term.joint, term.shape);
  }
  return stacked_columns(data.layout, data.recordings, *term.effect, term.joint, term.shape);
}

}  // namespace

MatrixXd columns_of(const Data& data, const Term& term) {
  MatrixXd columns = columns_of_all(data, term);
  if (term.effect->is_mass()) {
    // Every joint tells of it by its own torque constant.
    const RowLayout& layout = data.layout;
    for (Index joint = 0; joint < layout.joint_count(); ++joint) {
      const double scale = scale_known(data.recordings[0], joint);
      for (std::size_t r = 0; scale != 1 && r < layout.recording_count(); ++r) {
        columns.middleRows(layout.begin(r, joint), layout.samples(r)) *= scale;
      }
    }
  }
  if (term.during) {
    columns = within(shares_of(*term.during, data.recordings), data.layout, columns);
  }
  return columns;
}

Regression::Design Regression::design(const std::vector<Term>& terms) const {
  Design made;
  for (std::size_t i = 0; i < data_.nuisance.terms.size(); ++i) {
    const NuisanceTerm& nuisance = data_.nuisance.terms[i];
    if (nuisance.kind == NuisanceTerm::Kind::kSignShape &&
        !has_dry_friction(terms, nuisance.joint)) {
      continue;
    }
    const bool replaced = std::any_of(terms.begin(), terms.end(), [&](const Term& term) {
      return takes_place_of(term, nuisance);
    });
    if (!replaced) made.kept.push_back(static_cast<Index>(i));
  }
  std::vector<MatrixXd> of_terms;
  Index count = static_cast<Index>(made.kept.size());
  for (const Term& term : terms) {
    of_terms.push_back(columns_of(data_, term));
    made.first.push_back(count);
    count += of_terms.back().cols();
  }
  made.first.push_back(count);
  made.columns.resize(data_.layout.rows(), count);
  Index at = 0;
  for (const Index i : made.kept) {
    made.columns.col(at++) = data_.nuisance.columns.col(i);
    made.priors.push_back(data_.nuisance.terms[static_cast<std::size_t>(i)].prior);
  }
  for (const MatrixXd& of_term : of_terms) {
    made.columns.middleCols(at, of_term.cols()) = of_term;
    at += of_term.cols();
  }
  made.priors.resize(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < terms.size(); ++i) {
    for (std::size_t c = 0; c < terms[i].given.size(); ++c) {
      if (!terms[i].given[c]) continue;
      made.priors[static_cast<std::size_t>(made.first[i]) + c] = Prior::at(*terms[i].given[c]);
    }
  }
  return made;
}

namespace {

// The rows of the priors in the basis.
MatrixXd rows_of_priors(const std::vector<Prior>& priors, double prior_weight,
                        const MatrixXd& to_basis) {
  MatrixXd rows(static_cast<Index>(priors.size()), to_basis.cols());
  Index count = 0;
  for (std::size_t i = 0; i < priors.size(); ++i) {
    if (!priors[i].is_informative()) continue;
    rows.row(count++) = row_of(priors[i], prior_weight) * to_basis.row(static_cast<Index>(i));
  }
  rows.conservativeResize(count, Eigen::NoChange);
  return rows;
}

// What a fit of the terms leaves; `row_weights`: of the rows of the data, `to_basis` as in
// PriorFit.
Basis basis_of(const Data& data, std::vector<Term> terms, VectorXd row_weights, double prior_weight,
               MatrixXd to_basis) {
  return Basis([&data, terms = std::move(terms), row_weights = std::move(row_weights), prior_weight,
                to_basis = std::move(to_basis)] {
    const Regression::Design made = Regression(data).design(terms);
    const MatrixXd of_priors = rows_of_priors(made.priors, prior_weight, to_basis);
    MatrixXd basis(row_weights.size() + of_priors.rows(), to_basis.cols());
    basis.topRows(row_weights.size()).noalias() = made.columns * to_basis;
    basis.topRows(row_weights.size()).array().colwise() *= row_weights.array();
    basis.bottomRows(of_priors.rows()) = of_priors;
    return basis;
  });
}

}  // namespace

ModelFit Regression::fit(const std::vector<Term>& terms, const std::vector<char>& rows) const {
  const RowLayout& layout = data_.layout;
  const Design made = design(terms);
  const FewRowsOfJoints turned(layout, made.columns, data_.target, rows);
  ModelFit result;
  PriorFit fitted;
  VectorXd spread = layout.rms(data_.target);
  VectorXd independent;
  for (int pass = 0; pass < 2; ++pass) {
    const double floor = 1e-9 * layout.rms(data_.torque).maxCoeff() + 1e-300;
    result.joint_weights = spread.cwiseMax(floor).cwiseInverse();
    // Where no row counts, as in stretches that are all at fault, there is nothing but the priors.
    if (pass > 0 && independent.sum() > 0) {
      result.prior_weight = std::sqrt(static_cast<double>(layout.rows()) / independent.sum());
    }
    const RegressionRows weighted = turned.weighted(result.joint_weights);
    fitted = least_squares_with_priors(weighted.columns, weighted.target, made.priors,
                                       result.prior_weight);
    result.residual = data_.target - made.columns * fitted.x;
    spread = layout.rms(result.residual);
    independent = independent_samples_of(layout, result.residual);
  }
  complete(result, made, terms, std::move(fitted), independent, rows);
  return result;
}

ModelFit Regression::fit_weighted_as(const ModelFit& like, const std::vector<Term>& terms) const {
  const Design made = design(terms);
  const RegressionRows weighted =
      FewRowsOfJoints(data_.layout, made.columns, data_.target, {}).weighted(like.joint_weights);
  ModelFit result;
  result.joint_weights = like.joint_weights;
  result.prior_weight = like.prior_weight;
  PriorFit fitted = least_squares_with_priors(weighted.columns, weighted.target, made.priors,
                                              result.prior_weight);
  result.residual = data_.target - made.columns * fitted.x;
  complete(result, made, terms, std::move(fitted), like.remainder.independent_samples, {});
  return result;
}

void Regression::complete(ModelFit& result, const Design& made, const std::vector<Term>& terms,
                          PriorFit fitted, const VectorXd& independent_samples,
                          const std::vector<char>& rows) const {
  const RowLayout& layout = data_.layout;
  result.nuisance = VectorXd::Zero(data_.nuisance.columns.cols());
  for (std::size_t i = 0; i < made.kept.size(); ++i) {
    result.nuisance[made.kept[i]] = fitted.x[static_cast<Index>(i)];
  }
  for (std::size_t i = 0; i < terms.size(); ++i) {
    result.coefficients.push_back(
        fitted.x.segment(made.first[i], made.first[i + 1] - made.first[i]));
    for (std::size_t c = 0; c < terms[i].given.size(); ++c) {
      if (terms[i].given[c]) result.coefficients[i][static_cast<Index>(c)] = *terms[i].given[c];
    }
  }
  VectorXd row_weights = layout.weighted(VectorXd::Ones(layout.rows()), result.joint_weights);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i] == 0) row_weights[static_cast<Index>(i)] = 0;
  }
  Remainder& remainder = result.remainder;
  remainder.layout = &layout;
  remainder.independent_samples = independent_samples;
  remainder.joint_weights = result.joint_weights;
  const auto of_priors = std::count_if(made.priors.begin(), made.priors.end(),
                                       [](const Prior& one) { return one.is_informative(); });
  remainder.residual.resize(layout.rows() + of_priors);
  remainder.residual << row_weights.cwiseProduct(result.residual), fitted.residual.tail(of_priors);
  remainder.blocks = layout.blocks(kShortestBlockS);
  remainder.prior_weight = result.prior_weight;
  remainder.energy = layout.energy(remainder.residual);
  remainder.basis = basis_of(data_, terms, std::move(row_weights), result.prior_weight,
                             std::move(fitted.to_basis));
}

void Regression::refine(std::vector<Term>& terms, std::size_t which) const {
  if (!terms[which].is_searched()) return;
  std::vector<Term> others = terms;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(which));
  const ModelFit beside = fit(others);
  refine(terms, which, beside, Judge(beside.remainder));
}

bool Regression::holds_an_end(const ModelFit& fit) const {
  for (std::size_t i = 0; i < data_.nuisance.terms.size(); ++i) {
    const Prior& prior = data_.nuisance.terms[i].prior;
    const double x = fit.nuisance[static_cast<Index>(i)];
    if (prior.is_informative() && (x <= prior.low || x >= prior.high)) return true;
  }
  return false;
}

void Regression::refine(std::vector<Term>& terms, std::size_t which, const ModelFit& beside,
                        const Judge& judge) const {
  if (!terms[which].is_searched()) return;
  if (!holds_an_end(beside)) {
    const auto gain = [&](const Term& trial) { return judge.gain(columns_of(data_, trial)); };
    slide(data_, terms[which], gain, [&](const MatrixXd& columns) -> std::optional<VectorXd> {
      const Evidence evidence = judge.evidence(columns);
      if (!evidence.usable) return std::nullopt;
      return evidence.coefficients;
    });
    climb(terms[which], gain);
    return;
  }
  // Without the term a nuisance may stand at an end where it does not belong with it: a payload
  // looks like a heavier link. With what the model leaves as it is now, everything else adapts.
  std::vector<Term> others = terms;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(which));
  const ModelFit now = fit(terms);
  const Design made = design(others);
  const VectorXd weights =
      data_.layout.weighted(VectorXd::Ones(data_.layout.rows()), now.joint_weights);
  const MatrixXd weighted = weights.asDiagonal() * made.columns;
  const VectorXd target = weights.cwiseProduct(data_.target);
  const ProfileFit profile(weighted, target, made.priors, now.prior_weight);
  const auto gain = [&](const Term& trial) {
    return -profile.energy_with(weights.asDiagonal() * columns_of(data_, trial));
  };
  // Which point of the grid it came from was judged without it, too. A spectrum has thousands of
  // them, and one that is not the peak is none.
  const bool spectral = terms[which].effect->spectrum() != EffectCandidate::Spectrum::kNone;
  if (!spectral) jump(terms[which], gain);
  slide(data_, terms[which], gain, [&](const MatrixXd& columns) -> std::optional<VectorXd> {
    return profile.unknowns_of(weights.asDiagonal() * columns);
  });
  climb(terms[which], gain);
}

}  // namespace offnominal::desk
