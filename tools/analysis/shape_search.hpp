#pragma once

#include <functional>
#include <map>
#include <vector>

#include "analysis/fit_problem.hpp"
#include "analysis/normal_equations.hpp"

namespace offnominal::tools {

// Called now and then during a long search.
using OnStep = std::function<void()>;

// Searches for the shape values that give the smallest cost of least squares in the linear unknowns
// (variable projection, G. H. Golub, V. Pereyra, SIAM J. Numer. Anal. 10(2), 1973): the groups'
// grids first, then continuously between the grid's points. What has been computed is kept, so that
// searches that leave out different parts of the recording share their work.
class ShapeSearch {
 public:
  // part_of[i]: the part of sample i that search(part) can leave out; negative: never used.
  ShapeSearch(const FitProblem& problem, std::vector<int> part_of, int part_count,
              std::vector<double> weights, OnStep on_step = {});

  // The best shape values without the samples of `left_out` (negative: none left out). A start that
  // is as good as the best (to 1e-6 of the cost) is kept.
  std::vector<double> search(int left_out = -1);

  // Sums of products at these shape values, per part.
  const NormalEquations& equations(const std::vector<double>& shapes);

 private:
  double cost(const std::vector<double>& shapes, int left_out);
  std::vector<double> candidates(std::size_t group, const std::vector<double>& at, int left_out);
  void scan(std::size_t group, int left_out, std::vector<double>& best, double& best_cost);
  void scan_pairs(int left_out, std::vector<double>& best, double& best_cost);
  void refine(std::size_t group, int left_out, std::vector<double>& best, double& best_cost);

  const FitProblem& problem_;
  std::vector<int> part_of_;
  int part_count_;
  std::vector<double> weights_;
  std::vector<UnknownPrior> priors_;
  OnStep on_step_;
  std::map<std::vector<double>, NormalEquations> known_;
};

// The `most` highest local maxima, in ascending order, of the periodogram of `values` over `phase`:
// the power at sin(k phase), cos(k phase) for every k of an evenly stepped grid.
std::vector<double> periodogram_peaks(const Eigen::Ref<const Eigen::VectorXd>& phase,
                                      const Eigen::Ref<const Eigen::VectorXd>& values,
                                      const std::vector<double>& grid, std::size_t most);

}  // namespace offnominal::tools
