#include "identify/shape_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "identify/shape_grid.hpp"
#include "signal/periodogram.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

std::vector<ShapePoint> spectral_peaks(const Data& data, const Term& term, const Remainder& at) {
  constexpr std::size_t kPeaks = 6;
  const RowLayout& layout = data.layout;
  const std::vector<double>& grid = term.ranges[0].grid;
  const bool position = term.effect->spectrum() == EffectCandidate::Spectrum::kPosition;
  // Orders count periods of the position.
  const double unit = position ? 2 * std::numbers::pi /
                                     first_order_period(data.recordings[0].joint_type(term.joint))
                               : 1.0;
  VectorXd power = VectorXd::Zero(static_cast<Index>(grid.size()));
  for (std::size_t r = 0; r < layout.recording_count(); ++r) {
    const Workspace& workspace = data.recordings[r];
    const VectorXd variable = position ? VectorXd(workspace.motion.q.col(term.joint))
                                       : VectorXd(workspace.motion.t_s.array() - workspace.start_s);
    const VectorXd phase = unit * kept_samples(workspace.plan, variable);
    const std::vector<double> own = periodogram(
        phase, at.residual.segment(layout.begin(r, term.joint), layout.samples(r)), grid);
    power += Eigen::Map<const VectorXd>(own.data(), power.size());
  }
  std::vector<ShapePoint> points;
  for (const double value : highest_peaks(grid, {power.begin(), power.end()}, kPeaks)) {
    points.push_back({value});
  }
  return points;
}

namespace {

bool is_spectral(const Term& term) {
  return term.effect->spectrum() != EffectCandidate::Spectrum::kNone;
}

std::ptrdiff_t shaped(const std::vector<Term>& terms) {
  return std::count_if(terms.begin(), terms.end(),
                       [](const Term& term) { return !term.ranges.empty(); });
}

double energy_left(const Regression& regression, const std::vector<Term>& terms) {
  return regression.data().layout.energy(regression.fit(terms).residual).sum();
}

std::vector<Term> without(const std::vector<Term>& terms, std::size_t which) {
  std::vector<Term> others = terms;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(which));
  return others;
}

// A term's shape at the point of its grid where the model with it leaves least.
void scan(const Regression& regression, const std::vector<Term>& others, Term& term) {
  const Data& data = regression.data();
  const ModelFit beside = regression.fit(others);
  const bool given = term.ranges.size() == 1 && term.ranges[0].grid.size() == 1;
  const std::vector<ShapePoint> points = is_spectral(term) && !given
                                             ? spectral_peaks(data, term, beside.remainder)
                                             : product_grid(term.ranges);
  if (points.empty()) return;
  const Regression::Design made = regression.design(others);
  const VectorXd weights =
      data.layout.weighted(VectorXd::Ones(data.layout.rows()), beside.joint_weights);
  const ProfileFit profile(weights.asDiagonal() * made.columns, weights.cwiseProduct(data.target),
                           made.priors, beside.prior_weight);
  double least = std::numeric_limits<double>::infinity();
  ShapePoint best = points.front();
  for (const ShapePoint& point : points) {
    Term trial = term;
    trial.shape = point;
    const double left = profile.energy_with(weights.asDiagonal() * columns_of(data, trial));
    if (!(left < least)) continue;
    least = left;
    best = point;
  }
  term.shape = std::move(best);
}

}  // namespace

void fit_shapes(const Regression& regression, std::vector<Term>& terms,
                const OnProgress& on_progress) {
  const auto tell = [&] {
    if (on_progress) on_progress("fitting");
  };
  for (std::size_t i = 0; i < terms.size(); ++i) {
    tell();
    // Later ones have no shape yet.
    std::vector<Term> so_far(terms.begin(), terms.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    scan(regression, without(so_far, i), so_far[i]);
    regression.refine(so_far, i);
    terms[i] = so_far[i];
  }
  constexpr int kMostTurns = 4;
  constexpr double kWorthAnotherTurn = 1e-3;  // of what is left
  double left = energy_left(regression, terms);
  for (int turn = 0; turn < kMostTurns && shaped(terms) > 1; ++turn) {
    tell();
    for (std::size_t i = 0; i < terms.size(); ++i) {
      if (terms[i].ranges.empty()) continue;
      if (!is_spectral(terms[i])) scan(regression, without(terms, i), terms[i]);
      regression.refine(terms, i);
    }
    const double now = energy_left(regression, terms);
    if (!(now < (1 - kWorthAnotherTurn) * left)) break;
    left = now;
  }
}

void fit_shapes_again(const Regression& regression, std::vector<Term>& terms) {
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (terms[i].ranges.empty()) continue;
    if (is_spectral(terms[i])) scan(regression, without(terms, i), terms[i]);
    regression.refine(terms, i);
  }
}

}  // namespace offnominal::desk
