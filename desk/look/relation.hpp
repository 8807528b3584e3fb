#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

namespace offnominal::desk {

// How a column that should be a velocity goes with the derivative of a position.
struct Relation {
  // Times the derivative; below 0 where the signs are opposed. None: nothing in common, or not
  // judged.
  std::optional<double> ratio;
  double correlation = 0;  // -1 to 1
  std::string not_judged;  // why; empty: it was judged
};

// Correlation of a velocity with the derivative of its position, at least.
inline constexpr double kDerivativeCorrelation = 0.95;

// Whether a correlation is hardly worse than the best: noise, or a torque of viscous friction, may
// be what parts them. Of nothing in common (0 or below) it is none.
[[nodiscard]] bool is_hardly_worse(double correlation, double best);

// Rows that are judged, where a recording has more of them: in its middle.
struct JudgedRows {
  Eigen::Index first = 0;
  Eigen::Index count = 0;
};
[[nodiscard]] JudgedRows judged_rows(Eigen::Index rows);

// Fewer samples of a stretch are not judged.
inline constexpr Eigen::Index kFewestJudged = 200;

// Over the longest stretch of rows without gap, NaN or infinity. Lengths may differ, time need not
// be even, and a position may be folded into a turn.
[[nodiscard]] Relation relation_of(const Eigen::VectorXd& position, const Eigen::VectorXd& velocity,
                                   const Eigen::VectorXd& t_s);

// Rows of the longest stretch in which all of it is finite and no step of time is longer than twice
// the median.
struct UnbrokenRows {
  Eigen::Index first = 0;
  Eigen::Index count = 0;
  bool has_not_finite = false;  // anywhere
  bool has_gap = false;
};
[[nodiscard]] UnbrokenRows longest_stretch(const Eigen::VectorXd& t_s,
                                           const Eigen::MatrixXd& columns);

// What is compared: low-passed without phase, on an even clock, and its derivative. Of a stretch.
struct Smoothed {
  Eigen::VectorXd value;
  Eigen::VectorXd slope;
};
[[nodiscard]] Smoothed smoothed(const Eigen::VectorXd& x, const Eigen::VectorXd& t_s);
// Of two that stand on the same clock.
[[nodiscard]] Relation relation_of(const Smoothed& position, const Smoothed& velocity);

}  // namespace offnominal::desk
