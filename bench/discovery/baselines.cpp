#include "baselines.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

#include "candidate_columns.hpp"
#include "identify/data.hpp"

namespace offnominal::bench {

using desk::Data;
using desk::EffectAt;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

struct Contribution {
  EffectAt what;
  double energy = 0;
};

Effects largest_first(std::vector<Contribution> contributions) {
  std::stable_sort(
      contributions.begin(), contributions.end(),
      [](const Contribution& a, const Contribution& b) { return a.energy > b.energy; });
  Effects effects;
  for (const Contribution& one : contributions) effects.push_back(one.what);
  return effects;
}

// Orthonormal basis of what the columns span, without directions that are nearly nothing.
MatrixXd span_of(const MatrixXd& columns, double scale) {
  Eigen::ColPivHouseholderQR<MatrixXd> qr(columns);
  constexpr double kNothing = 1e-6;
  Index rank = 0;
  while (rank < columns.cols() && std::abs(qr.matrixR()(rank, rank)) > kNothing * scale) ++rank;
  return qr.householderQ() * MatrixXd::Identity(columns.rows(), rank);
}

// One more effect for as long as n log(RSS / n) + k log(n) falls.
Effects stepwise(std::vector<CandidateColumns> open, VectorXd residual) {
  constexpr std::size_t kMost = 40;
  const auto n = static_cast<double>(residual.size());
  std::vector<double> scale;
  for (const CandidateColumns& one : open) scale.push_back(one.columns.norm());
  std::vector<bool> used(open.size(), false);
  std::vector<Contribution> selected;
  while (selected.size() < kMost) {
    const double energy = residual.squaredNorm();
    double best = 0;
    std::size_t which = 0;
    MatrixXd span;
    for (std::size_t i = 0; i < open.size(); ++i) {
      if (used[i] || !(scale[i] > 0)) continue;
      const MatrixXd q = span_of(open[i].columns, scale[i]);
      const double left = energy - (q.transpose() * residual).squaredNorm();
      const double fall =
          -n * std::log(left / energy) - static_cast<double>(q.cols()) * std::log(n);
      if (!(fall > best)) continue;
      best = fall;
      which = i;
      span = q;
    }
    if (!(best > 0)) break;
    residual -= span * (span.transpose() * residual);
    selected.push_back({open[which].what, energy - residual.squaredNorm()});
    for (std::size_t i = 0; i < open.size(); ++i) {
      used[i] = used[i] || open[i].what == open[which].what;
      if (!used[i]) open[i].columns -= span * (span.transpose() * open[i].columns);
    }
  }
  return largest_first(std::move(selected));
}

// Columns of unit length of all candidates side by side, and whose they are.
struct Library {
  MatrixXd columns;
  std::vector<std::size_t> owner;
};

Library library_of(const std::vector<CandidateColumns>& candidates, Index rows) {
  Library library;
  std::vector<VectorXd> kept;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    for (Index c = 0; c < candidates[i].columns.cols(); ++c) {
      const VectorXd column = candidates[i].columns.col(c);
      if (!(column.norm() > 0)) continue;
      kept.emplace_back(column.normalized());
      library.owner.push_back(i);
    }
  }
  library.columns.resize(rows, static_cast<Index>(kept.size()));
  for (std::size_t c = 0; c < kept.size(); ++c) {
    library.columns.col(static_cast<Index>(c)) = kept[c];
  }
  return library;
}

// Ridge regression of the kept columns; coefficients below the threshold are dropped until none is.
// The residual has unit length too: the threshold is a share of it. Both numbers are the defaults
// that PySINDy documents (threshold 0.1, alpha 0.05), and were not tuned.
Effects thresholded(const std::vector<CandidateColumns>& candidates, const VectorXd& residual) {
  constexpr double kThreshold = 0.1;
  constexpr double kRidge = 0.05;
  const Library library = library_of(candidates, residual.size());
  const MatrixXd gram = library.columns.transpose() * library.columns;
  const VectorXd moments = library.columns.transpose() * residual.normalized();
  std::vector<Index> kept;
  for (Index c = 0; c < moments.size(); ++c) kept.push_back(c);
  VectorXd x;
  while (!kept.empty()) {
    MatrixXd part = gram(kept, kept);
    part.diagonal().array() += kRidge;
    x = part.ldlt().solve(moments(kept));
    std::vector<Index> left;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      if (std::abs(x[static_cast<Index>(i)]) >= kThreshold) left.push_back(kept[i]);
    }
    if (left.size() == kept.size()) break;
    kept = std::move(left);
  }
  std::vector<std::pair<EffectAt, VectorXd>> torques;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const EffectAt& what = candidates[library.owner[static_cast<std::size_t>(kept[i])]].what;
    const VectorXd torque = x[static_cast<Index>(i)] * library.columns.col(kept[i]);
    const auto same = std::find_if(torques.begin(), torques.end(),
                                   [&](const auto& one) { return one.first == what; });
    if (same == torques.end()) {
      torques.emplace_back(what, torque);
    } else {
      same->second += torque;
    }
  }
  std::vector<Contribution> contributions;
  for (const auto& [what, torque] : torques) contributions.push_back({what, torque.squaredNorm()});
  return largest_first(std::move(contributions));
}

}  // namespace

BaselineSelections select_by_baselines(const desk::RobotDescription& robot,
                                       const desk::Log& recording) {
  const std::vector<desk::Log> logs{recording};
  desk::RobotDescription prepared = robot;
  const auto plan = desk::plan_filter(logs, prepared);
  const VectorXd widths = desk::set_sign_widths(prepared, logs, plan);
  std::vector<desk::Workspace> workspaces;
  workspaces.push_back(desk::make_workspace(recording, prepared, plan, widths));
  const Data data(std::move(workspaces), prepared, {});
  const NuisanceFit fit = fit_nuisance(data);
  const std::vector<CandidateColumns> candidates = candidate_columns(data, fit);
  return {stepwise(candidates, fit.residual), thresholded(candidates, fit.residual)};
}

}  // namespace offnominal::bench
