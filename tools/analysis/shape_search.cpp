#include "analysis/shape_search.hpp"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <numbers>

#include "analysis/shape_grid.hpp"
#include "signal/periodogram.hpp"

namespace offnominal::tools {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

ShapeSearch::ShapeSearch(const FitProblem& problem, std::vector<int> part_of, int part_count,
                         std::vector<double> weights, OnStep on_step)
    : problem_(problem),
      part_of_(std::move(part_of)),
      part_count_(part_count),
      weights_(std::move(weights)),
      priors_(problem.priors()),
      on_step_(std::move(on_step)) {}

const NormalEquations& ShapeSearch::equations(const std::vector<double>& shapes) {
  auto found = known_.find(shapes);
  if (found == known_.end()) {
    NormalEquations computed(problem_.rows(shapes), part_of_, part_count_);
    found = known_.emplace(shapes, std::move(computed)).first;
    if (on_step_) on_step_();
  }
  return found->second;
}

double ShapeSearch::cost(const std::vector<double>& shapes, int left_out) {
  return solve(equations(shapes).sum(weights_, left_out), priors_).cost;
}

std::vector<double> ShapeSearch::search(int left_out) {
  constexpr double kAsGood = 1 + 1e-6;
  constexpr int kSweeps = 3;
  const std::size_t count = problem_.groups().size();
  if (count == 0) return problem_.start_shapes();
  const std::vector<double> start = problem_.start_shapes();
  const double start_cost = cost(start, left_out);
  std::vector<double> best = start;
  double best_cost = start_cost;
  if (count == 2) {
    scan_pairs(left_out, best, best_cost);
  } else {
    for (std::size_t group = 0; group < count; ++group) scan(group, left_out, best, best_cost);
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const double before = best_cost;
    for (std::size_t group = 0; group < count; ++group) refine(group, left_out, best, best_cost);
    if (count == 1 || best_cost > before * (1 - 1e-9)) break;
  }
  return start_cost <= best_cost * kAsGood ? start : best;
}

std::vector<double> ShapeSearch::candidates(std::size_t group, const std::vector<double>& at,
                                            int left_out) {
  constexpr std::size_t kMost = 8;
  const ShapeGroup& of = problem_.groups()[group];
  const bool spectral =
      of.search == ShapeGroup::Search::kPeriodicQ || of.search == ShapeGroup::Search::kPeriodicTime;
  if (!spectral) return of.grid;
  const std::size_t effect = of.members[0].effect;
  const std::size_t joint = problem_.robot().effects[effect].joint;
  std::vector<JointRows> rows = problem_.rows(at);
  for (JointRows& joint_rows : rows) {
    for (std::size_t i = 0; i < problem_.unknowns().size(); ++i) {
      const Unknown& unknown = problem_.unknowns()[i];
      const bool own = unknown.kind == Unknown::Kind::kEffectParameter && unknown.effect == effect;
      if (own) joint_rows.columns.col(static_cast<Index>(i)).setZero();
    }
  }
  const NormalEquations without(rows, part_of_, part_count_);
  const VectorXd x = solve(without.sum(weights_, left_out), priors_).x;
  const Measurement& measured = problem_.measured();
  const bool in_time = of.search == ShapeGroup::Search::kPeriodicTime;
  VectorXd phase =
      in_time ? measured.t_s
              : kept_samples(measured.plan, measured.motion.q.col(static_cast<Index>(joint)));
  if (!in_time) {
    phase *= 2 * std::numbers::pi / first_order_period(problem_.robot().joints[joint].joint.type);
  }
  for (const JointRows& joint_rows : rows) {
    if (joint_rows.joint != joint) continue;
    VectorXd error = residual_of(joint_rows, x);
    for (Index i = 0; i < error.size(); ++i) {
      const int part = part_of_[static_cast<std::size_t>(i)];
      if (part < 0 || part == left_out) error[i] = 0;
    }
    return periodogram_peaks(phase, error, of.grid, kMost);
  }
  return {};
}

void ShapeSearch::scan(std::size_t group, int left_out, std::vector<double>& best,
                       double& best_cost) {
  std::vector<double> trial = best;
  for (const double value : candidates(group, best, left_out)) {
    trial[group] = value;
    const double trial_cost = cost(trial, left_out);
    if (trial_cost < best_cost) {
      best_cost = trial_cost;
      best[group] = value;
    }
  }
}

void ShapeSearch::scan_pairs(int left_out, std::vector<double>& best, double& best_cost) {
  const std::vector<double> first = candidates(0, best, left_out);
  const std::vector<double> second = candidates(1, best, left_out);
  for (const double a : first) {
    for (const double b : second) {
      const double trial_cost = cost({a, b}, left_out);
      if (trial_cost >= best_cost) continue;
      best_cost = trial_cost;
      best = {a, b};
    }
  }
}

void ShapeSearch::refine(std::size_t group, int left_out, std::vector<double>& best,
                         double& best_cost) {
  constexpr int kBits = 16;
  const ShapeGroup& of = problem_.groups()[group];
  if (of.search == ShapeGroup::Search::kDiscrete) return;
  const auto above = std::upper_bound(of.grid.begin(), of.grid.end(), best[group]);
  const auto below = std::lower_bound(of.grid.begin(), of.grid.end(), best[group]);
  double low = below == of.grid.begin() ? of.grid.front() : *std::prev(below);
  double high = above == of.grid.end() ? of.grid.back() : *above;
  if (!(low < high)) return;
  const auto value_of = [&](double u) { return of.logarithmic ? std::exp(u) : u; };
  if (of.logarithmic) {
    low = std::log(low);
    high = std::log(high);
  }
  std::vector<double> trial = best;
  std::uintmax_t most = 24;
  const auto [u, found] = boost::math::tools::brent_find_minima(
      [&](double at) {
        trial[group] = value_of(at);
        return cost(trial, left_out);
      },
      low, high, kBits, most);
  if (found >= best_cost) return;
  best_cost = found;
  best[group] = value_of(u);
}

std::vector<double> periodogram_peaks(const Eigen::Ref<const VectorXd>& phase,
                                      const Eigen::Ref<const VectorXd>& values,
                                      const std::vector<double>& grid, std::size_t most) {
  return highest_peaks(grid, periodogram(phase, values, grid), most);
}

}  // namespace offnominal::tools
