#include "candidate_columns.hpp"

#include <string_view>
#include <utility>

namespace offnominal::bench {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using tools::discovery::EffectCandidate;
using tools::discovery::ModelFit;
using tools::discovery::Regressor;
using tools::discovery::RowLayout;
using tools::discovery::Search;
using tools::discovery::ShapePoint;
using tools::discovery::Term;

namespace {

// First, middle and last of what is there.
std::vector<ShapePoint> few_of(const std::vector<ShapePoint>& grid) {
  if (grid.size() <= 3) return grid;
  return {grid.front(), grid[grid.size() / 2], grid.back()};
}

// Energy of the residual that a sine and a cosine take, unfiltered columns.
double peak_height(const Search& search, const ModelFit& fit, const Term& term, double at) {
  const auto& data = search.data();
  const ShapePoint shape{at};
  MatrixXd wave(data.layout.rows(), 2);
  std::vector<Regressor> sines;
  std::vector<Regressor> cosines;
  for (const auto& recording : data.recordings) {
    std::vector<Regressor> both = term.effect->regressors(recording, term.joint, shape);
    sines.push_back(std::move(both[0]));
    cosines.push_back(std::move(both[1]));
  }
  wave.col(0) = data.layout.stack_kept(data.recordings, sines);
  wave.col(1) = data.layout.stack_kept(data.recordings, cosines);
  return (wave.transpose() * fit.residual).squaredNorm();
}

std::vector<ShapePoint> highest_peak(const Search& search, const ModelFit& fit, const Term& term) {
  constexpr std::size_t kStride = 2;  // the grids are twice as fine as a peak is wide
  double best = -1;
  ShapePoint shape;
  const std::vector<double>& grid = term.ranges[0].grid;
  for (std::size_t i = 0; i < grid.size(); i += kStride) {
    const double height = peak_height(search, fit, term, grid[i]);
    if (height <= best) continue;
    best = height;
    shape = {grid[i]};
  }
  if (shape.empty()) return {};
  return {shape};
}

bool is_known(const Search& search, const EffectCandidate& effect, Index joint) {
  for (const auto& known : search.data().recordings[0].known_effects) {
    if (known.joint == joint && effect.spectrum() == EffectCandidate::Spectrum::kNone &&
        std::string_view(info_of(known.kind)->name) == effect.name()) {
      return true;
    }
  }
  return false;
}

}  // namespace

std::vector<CandidateColumns> candidate_columns(const Search& search,
                                                const ModelFit& nuisance_fit) {
  const auto& data = search.data();
  const MatrixXd& basis = nuisance_fit.remainder.basis;
  std::vector<CandidateColumns> all;
  for (const auto& effect : tools::discovery::all_candidates()) {
    for (Index joint = 0; joint < data.layout.joint_count(); ++joint) {
      if (!effect->applies(data.recordings[0], joint) || is_known(search, *effect, joint)) continue;
      Term term{effect.get(), joint, {}, effect->shapes(data.recordings, joint)};
      const bool spectral = effect->spectrum() != EffectCandidate::Spectrum::kNone;
      for (const ShapePoint& shape :
           spectral ? highest_peak(search, nuisance_fit, term) : few_of(Search::grid_of(term))) {
        term.shape = shape;
        MatrixXd columns = Search::columns_of(data, term);
        for (Index c = 0; c < columns.cols(); ++c) {
          columns.col(c) = data.layout.weighted(columns.col(c), nuisance_fit.joint_weights);
        }
        columns -= basis * (basis.transpose() * columns);
        all.push_back({{effect->name(), joint}, std::move(columns)});
      }
    }
  }
  return all;
}

}  // namespace offnominal::bench
