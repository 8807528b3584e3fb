#include "candidate_columns.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "explain/search.hpp"
#include "identify/fit.hpp"

namespace offnominal::bench {

using desk::Data;
using desk::EffectCandidate;
using desk::NuisanceTerm;
using desk::Prior;
using desk::Regressor;
using desk::Search;
using desk::ShapePoint;
using desk::Term;
using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// First, middle and last of what is there.
std::vector<ShapePoint> few_of(const std::vector<ShapePoint>& grid) {
  if (grid.size() <= 3) return grid;
  return {grid.front(), grid[grid.size() / 2], grid.back()};
}

// The sine and the cosine of a spectrum at one frequency, unfiltered, stacked.
struct Wave {
  ArrayXd sine;
  ArrayXd cosine;
};

Wave wave_of(const Data& data, const Term& term, double frequency) {
  const ShapePoint shape{frequency};
  std::vector<Regressor> sines;
  std::vector<Regressor> cosines;
  for (const auto& recording : data.recordings) {
    std::vector<Regressor> both = term.effect->regressors(recording, term.joint, shape);
    sines.push_back(std::move(both[0]));
    cosines.push_back(std::move(both[1]));
  }
  return {data.layout.stack_kept(data.recordings, sines).array(),
          data.layout.stack_kept(data.recordings, cosines).array()};
}

// The grid's steps are even: each wave is the one before it, turned by the step's angle.
std::vector<ShapePoint> highest_peak(const Data& data, const NuisanceFit& fit, const Term& term) {
  const std::vector<double>& grid = term.ranges[0].grid;
  if (grid.size() < 2) return {};
  Wave wave = wave_of(data, term, grid[0]);
  const Wave step = wave_of(data, term, grid[1] - grid[0]);
  double best = -1;
  std::size_t which = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const double height = std::pow(wave.sine.matrix().dot(fit.residual), 2) +
                          std::pow(wave.cosine.matrix().dot(fit.residual), 2);
    if (height > best) {
      best = height;
      which = i;
    }
    const ArrayXd sine = wave.sine * step.cosine + wave.cosine * step.sine;
    wave.cosine = wave.cosine * step.cosine - wave.sine * step.sine;
    wave.sine = sine;
  }
  return {{grid[which]}};
}

bool knows(const Data& data, EffectKind kind, Index joint) {
  const auto& known = data.recordings[0].known_effects;
  return std::any_of(known.begin(), known.end(), [&](const desk::RobotEffect& one) {
    return one.joint == joint && one.kind == kind;
  });
}

}  // namespace

NuisanceFit fit_nuisance(const Data& data) {
  const auto& terms = data.nuisance.terms;
  std::vector<Index> kept;
  std::vector<Prior> priors;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const bool shape = terms[i].kind == NuisanceTerm::Kind::kSignShape;
    if (shape && !data.recordings[0].knows_dry_friction(terms[i].joint)) continue;
    kept.push_back(static_cast<Index>(i));
    // Only the ends: what these methods compute has no rows for a belief.
    priors.push_back({.low = terms[i].prior.low, .high = terms[i].prior.high});
  }
  const MatrixXd columns = data.nuisance.columns(Eigen::all, kept);
  const VectorXd ones = VectorXd::Ones(data.layout.rows());
  NuisanceFit fit;
  VectorXd spread = data.layout.rms(data.target);
  for (int pass = 0; pass < 2; ++pass) {
    fit.joint_weights = spread.cwiseInverse();
    const VectorXd weights = data.layout.weighted(ones, fit.joint_weights);
    const auto fitted = desk::least_squares_with_priors(
        weights.asDiagonal() * columns, weights.cwiseProduct(data.target), priors, 1);
    fit.residual = fitted.residual;
    fit.basis = fitted.basis;
    const VectorXd left = fitted.residual.cwiseQuotient(weights);
    spread = data.layout.rms((weights.array() > 0).select(left, 0));
  }
  return fit;
}

std::vector<CandidateColumns> candidate_columns(const Data& data, const NuisanceFit& fit) {
  std::vector<CandidateColumns> all;
  for (const auto& effect : desk::all_candidates()) {
    const bool spectral = effect->spectrum() != EffectCandidate::Spectrum::kNone;
    for (Index joint = 0; joint < data.layout.joint_count(); ++joint) {
      if (!effect->applies(data.recordings[0], joint)) continue;
      if (!spectral && knows(data, effect->kind(), joint)) continue;
      Term term{effect.get(), joint, {}, effect->shapes(data.recordings, joint)};
      for (const ShapePoint& shape :
           spectral ? highest_peak(data, fit, term) : few_of(Search::grid_of(term))) {
        term.shape = shape;
        MatrixXd columns = desk::columns_of(data, term);
        for (Index c = 0; c < columns.cols(); ++c) {
          columns.col(c) = data.layout.weighted(columns.col(c), fit.joint_weights);
        }
        columns -= fit.basis * (fit.basis.transpose() * columns);
        all.push_back({{effect->kind(), joint}, std::move(columns)});
      }
    }
  }
  return all;
}

}  // namespace offnominal::bench
