#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "identify/effect_candidate.hpp"
#include "identify/rows.hpp"
#include "identify/workspace.hpp"

namespace offnominal::desk {

// A part of a recording by its own time stamps: `from_s` and later, before `to_s`.
struct TimeSpan {
  std::string file;  // of the recording
  double from_s = 0;
  double to_s = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool holds(double t_s) const { return t_s >= from_s && t_s < to_s; }
};

// An effect on a joint that may be in the model.
struct Term {
  const EffectCandidate* effect = nullptr;
  Eigen::Index joint = 0;
  ShapePoint shape{};
  std::vector<ShapeRange> ranges{};
  // Coefficients that are given, not fitted; empty: none of them.
  std::vector<std::optional<double>> given{};
  // The only part of all recordings in which it acts; empty: it always does.
  std::optional<TimeSpan> during{};

  // Whether it has a shape that has to be looked for.
  [[nodiscard]] bool is_searched() const {
    return std::any_of(ranges.begin(), ranges.end(),
                       [](const ShapeRange& range) { return range.is_searched(); });
  }
};

// What is left of a constant 1 in every row where it is 1 in the span and 0 elsewhere: the low-pass
// that torques and regressors pass makes a slope of its ends. A regressor times this is what the
// filter makes of one that acts in the span alone, as far as it does not change during that slope.
Eigen::VectorXd rows_in(const TimeSpan& span, const RowLayout& layout,
                        const std::vector<Workspace>& recordings);

}  // namespace offnominal::desk
