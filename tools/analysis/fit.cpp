#include "analysis/fit.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/intervals.hpp"

namespace offnominal::tools {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::optional<Interval> around(double value, const HalfWidth& half_width) {
  if (!half_width.value) return std::nullopt;
  return Interval{value - *half_width.value, value + *half_width.value};
}

void take_linear(const FitProblem& problem, const LinearSolution& solution,
                 const Intervals& intervals, Fit& fit) {
  for (std::size_t i = 0; i < problem.unknowns().size(); ++i) {
    const Unknown& unknown = problem.unknowns()[i];
    const double value = solution.x[static_cast<Index>(i)];
    if (unknown.kind == Unknown::Kind::kLinkScale) {
      fit.links.push_back({unknown.joint, 1 + value, around(1 + value, intervals.linear[i])});
    } else {
      fit.parameters.push_back({unknown.effect, unknown.parameter, value,
                                around(value, intervals.linear[i]), intervals.linear[i].why_none,
                                !solution.is_fixed[i]});
    }
  }
  for (const Ambiguity& ambiguity : solution.ambiguities) {
    Indistinct indistinct{problem.unknowns()[ambiguity.fixed], {}};
    for (const std::size_t other : ambiguity.others) {
      indistinct.others.push_back(problem.unknowns()[other]);
    }
    fit.indistinct.push_back(std::move(indistinct));
  }
}

void take_shapes(const FitProblem& problem, const std::vector<double>& shapes,
                 const Intervals& intervals, Fit& fit) {
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    std::optional<Interval> ci95 = around(shapes[i], intervals.shape[i]);
    if (ci95 && problem.groups()[i].logarithmic) {
      const double factor = std::exp(*intervals.shape[i].value);
      ci95 = Interval{shapes[i] / factor, shapes[i] * factor};
    }
    for (const ShapeMember& member : problem.groups()[i].members) {
      fit.parameters.push_back(
          {member.effect, member.parameter, shapes[i], ci95, intervals.shape[i].why_none, true});
    }
  }
}

// Every part predicted by a fit of the others.
std::vector<HeldOutError> cross_validate(const FitProblem& problem, ShapeSearch& search,
                                         const std::vector<double>& weights) {
  std::vector<HeldOutError> errors;
  for (const std::size_t joint : problem.joints()) errors.push_back({joint, 0});
  for (int part = 0; part < kParts; ++part) {
    const NormalEquations& equations = search.equations(search.search(part));
    const VectorXd x = solve(equations.sum(weights, part), problem.priors()).x;
    for (std::size_t i = 0; i < errors.size(); ++i) {
      errors[i].squared_error += squared_error(equations.products(part, i), x);
    }
  }
  return errors;
}

}  // namespace

std::vector<int> contiguous_parts(Index samples, Index guard) {
  const Index length = std::max<Index>(1, samples / kPartBlocks);
  const Index most_guard = std::min(guard, length / 8);
  std::vector<int> part_of(static_cast<std::size_t>(samples));
  for (Index i = 0; i < samples; ++i) {
    const Index block = std::min<Index>(i / length, kPartBlocks - 1);
    const Index first = block * length;
    const Index end = block == kPartBlocks - 1 ? samples : first + length;
    const bool near_change = (block > 0 && i - first < most_guard) ||
                             (block < kPartBlocks - 1 && end - 1 - i < most_guard);
    part_of[static_cast<std::size_t>(i)] = near_change ? -1 : static_cast<int>(block % kParts);
  }
  return part_of;
}

Fit fit(const FitProblem& problem, const std::optional<std::vector<int>>& parts,
        const OnStep& on_step) {
  const std::vector<int> whole(static_cast<std::size_t>(problem.samples()), 0);
  const std::vector<UnknownPrior> priors = problem.priors();
  std::vector<double> shapes = problem.start_shapes();
  std::vector<JointRows> rows = problem.rows(shapes);

  std::vector<double> weights = likelihood_weights(rows, VectorXd::Zero(rows[0].columns.cols()));
  const NormalEquations at_start(rows, whole, 1);
  weights = likelihood_weights(rows, solve(at_start.sum(weights), priors).x);
  {
    ShapeSearch search(problem, whole, 1, weights, on_step);
    shapes = search.search();
  }
  rows = problem.rows(shapes);
  const NormalEquations equations(rows, whole, 1);
  LinearSolution solution = solve(equations.sum(weights), priors);
  weights = likelihood_weights(rows, solution.x);
  solution = solve(equations.sum(weights), priors);

  Fit result;
  result.robot = with_values(with_shapes(problem.robot(), problem.groups(), shapes),
                             problem.unknowns(), solution.x);
  result.values = solution.x;
  const Intervals intervals = intervals_of(problem, solution, shapes, weights);
  take_linear(problem, solution, intervals, result);
  take_shapes(problem, shapes, intervals, result);
  if (parts) {
    ShapeSearch search(problem, *parts, kParts, weights, on_step);
    result.held_out = cross_validate(problem, search, weights);
  }
  return result;
}

FitProblem settled(const FitProblem& problem, const OnStep& on_step) {
  if (problem.is_linear()) return problem;
  constexpr int kMost = 8;
  constexpr double kUnchanged = 1e-6;
  VectorXd at = fit(problem, std::nullopt, on_step).values;
  for (int pass = 1; pass < kMost; ++pass) {
    const VectorXd next = fit(problem.about(at), std::nullopt, on_step).values;
    const bool unchanged = (next - at).norm() <= kUnchanged * next.norm();
    at = next;
    if (unchanged) break;
  }
  return problem.about(at);
}

}  // namespace offnominal::tools
