#pragma once

#include <string>
#include <vector>

#include "analysis/fit.hpp"
#include "analysis/fit_problem.hpp"

namespace offnominal::tools {

// A parameter that was fitted, and one of an effect that the model does not have which would have
// explained the same torque in this recording.
struct Lookalike {
  Unknown fitted;
  EffectKind effect = EffectKind::kViscousFriction;
  std::string parameter;
};

// Lookalikes among the torque effects of the same joint that need no shape value to be given. Two
// columns look alike where, once all other fitted columns are taken out of both, the sine of the
// angle between them is below 0.07.
std::vector<Lookalike> lookalikes(const FitProblem& problem, const Fit& fit);

}  // namespace offnominal::tools
