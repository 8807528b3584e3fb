#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "identify/effect_candidate.hpp"
#include "identify/regression.hpp"

namespace offnominal::desk {

// A number with its 95 % interval; where the data give none, why, in words.
struct Estimate {
  NamedValue value;
  std::optional<std::array<double, 2>> ci95;
  std::string why_no_interval = {};
};

// Numbers of a fitted model with 95 % intervals: a covariance that is robust to errors correlated
// within a block of time (K.-Y. Liang, S. L. Zeger, Biometrika 73(1), 1986), shapes linearised
// about where they are, Student's t with the blocks that tell of the joint concerned less the
// unknowns of that joint (freedom.hpp). Where these are too few, or the recordings do not
// determine a number, it says so.
struct Estimates {
  std::vector<std::vector<Estimate>> terms;  // parameters of every term
  // Per nuisance term of the data: what it adds to the number that it is counted from. A time skew
  // and shapes of the sign have none.
  std::vector<Estimate> nuisance;
  std::vector<Estimate> widths;  // of the smoothed sign, as many as were asked for
};

// `robot`: what the regression's data were made with; `widths`: joints whose width was fitted too.
Estimates estimates_of(const Regression& regression, const RobotDescription& robot,
                       const std::vector<Term>& terms, const ModelFit& fit,
                       const std::vector<Eigen::Index>& widths = {});

}  // namespace offnominal::desk
