#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "analysis/fit_problem.hpp"
#include "analysis/shape_search.hpp"

namespace offnominal::tools {

using Interval = std::array<double, 2>;  // both ends

// One parameter of an effect after a fit.
struct FittedParameter {
  std::size_t effect = 0;  // index into the robot's effects
  std::size_t parameter = 0;
  double value = 0;
  std::optional<Interval> ci95;
  std::string why_no_interval = {};  // where it was fitted and has none, in words
  bool fitted = false;               // false: given, or left where it was
};

// Mass and inertia of one link after a fit, as a factor on what they were.
struct FittedLink {
  std::size_t link = 0;
  double factor = 1;
  std::optional<Interval> ci95;
};

// Parameters that the recording cannot tell apart; `fixed` was left at its start for it.
struct Indistinct {
  Unknown fixed;
  std::vector<Unknown> others;  // empty: the recording does not excite it at all
};

// Error of a fit on samples that it had not seen, one joint.
struct HeldOutError {
  std::size_t joint = 0;
  double squared_error = 0;  // summed over the held-out samples
};

struct Fit {
  RobotDescription robot;
  Eigen::VectorXd values;  // of the problem's unknowns
  std::vector<FittedParameter> parameters;
  std::vector<FittedLink> links;
  std::vector<Indistinct> indistinct;
  std::vector<HeldOutError> held_out;  // empty unless cross-validated
};

// Contiguous parts of a recording for cross-validation: kPartBlocks stretches of time, dealt out to
// kParts parts in turn. Samples next to a change of part are in none (-1), since the filter mixes
// them with the other part.
std::vector<int> contiguous_parts(Eigen::Index samples, Eigen::Index guard);
inline constexpr int kParts = 5;
inline constexpr int kPartBlocks = 20;

// Fits the unknowns and the shape groups of a problem. With parts (contiguous_parts()) every part
// is also predicted by a fit of the others, shape values included. on_step is called now and then.
// A problem that is not linear is taken as linear where it was made: settled() first.
Fit fit(const FitProblem& problem, const std::optional<std::vector<int>>& parts,
        const OnStep& on_step = {});

// The problem made about what its own fit gives, found by fitting again and again (Gauss-Newton).
// One that is linear comes back as it is.
FitProblem settled(const FitProblem& problem, const OnStep& on_step = {});

}  // namespace offnominal::tools
