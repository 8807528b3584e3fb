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

// What a term is linear in: of a drive's loss two numbers, of which one may well be nothing.
struct LinearPart {
  Eigen::VectorXd value;  // linear_numbers() of the term
  // Its 95 % region about the value, all numbers together: nothing lies on its edge where
  // value' region^-1 value is 1. Empty where the samples do not suffice to say.
  Eigen::MatrixXd region;

  // How far the term is from nothing, in half-widths of the region; infinite where that is unknown.
  [[nodiscard]] double from_nothing() const;
  // The same from all that is a multiple of `line`, which may be any.
  [[nodiscard]] double from_line(const Eigen::VectorXd& line) const;
  // Makes the region as much wider as one standard deviation of this says.
  void widen(const Eigen::VectorXd& deviation);
};

// The numbers that a term's torque is linear in: the regression's coefficients; of a mass whose
// place is searched the mass and its first moments, kg and kg m. Such a mass is nothing only where
// all of them are: recordings may know the moments well where they hardly tell a heavy mass near
// the joint from a light one far off.
Eigen::VectorXd linear_numbers(const Term& term, const Eigen::VectorXd& coefficients);

// Numbers of a fitted model with 95 % intervals: a covariance that is robust to errors correlated
// within a block of time (K.-Y. Liang, S. L. Zeger, Biometrika 73(1), 1986), shapes linearised
// about where they are, Student's t with the blocks that tell of the joint concerned less the
// unknowns of that joint (freedom.hpp). Where these are too few, or the recordings do not
// determine a number, it says so.
struct Estimates {
  std::vector<std::vector<Estimate>> terms;  // parameters of every term
  std::vector<LinearPart> linear;            // per term
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
