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

// A part of one recording by its own time stamps, `from_s` and later, before `to_s`; or several
// recordings as a whole.
struct TimeSpan {
  std::vector<std::string> files;  // of the recordings
  double from_s = -std::numeric_limits<double>::infinity();
  double to_s = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool begins() const { return from_s > -std::numeric_limits<double>::infinity(); }
  [[nodiscard]] bool ends() const { return to_s < std::numeric_limits<double>::infinity(); }
  [[nodiscard]] bool is_of(const std::string& file) const {
    return std::find(files.begin(), files.end(), file) != files.end();
  }
  [[nodiscard]] bool holds(double t_s) const { return t_s >= from_s && t_s < to_s; }
};

// "from 14.98 s of a.csv on", "from 3 to 9 s of a.csv", "in b.csv and c.csv".
std::string words_of(const TimeSpan& span);

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

// Whether an effect with these coefficients can be on a drive (EffectCandidate::is_physical) and is
// one that the recordings can show (is_within_reach); and of a mass that is less than nothing,
// whether its link has so much to lose. What has changed meanwhile may have been carried.
bool can_be(const Term& term, const Eigen::VectorXd& coefficients,
            const std::vector<Workspace>& recordings);

// Per recording, at its filtered samples, what the low-pass that torques and regressors pass makes
// of a 1 in the span and a 0 elsewhere; empty where the span is of other recordings. A regressor
// times this is what the filter makes of one that acts in the span alone, as far as it does not
// change during the slopes at the span's ends.
std::vector<Eigen::VectorXd> shares_of(const TimeSpan& span,
                                       const std::vector<Workspace>& recordings);

// Stacked columns times such shares; 0 in other recordings.
Eigen::MatrixXd within(const std::vector<Eigen::VectorXd>& shares, const RowLayout& layout,
                       const Eigen::MatrixXd& columns);

}  // namespace offnominal::desk
