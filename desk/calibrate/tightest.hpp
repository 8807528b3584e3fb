#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "calibrate/recorded_error.hpp"

namespace offnominal::desk {

/// What the threshold has to reach at each row of a part, in runs that start so many ticks earlier;
/// of none (0 ticks, 0 kept): in the run that the rows are of. 0: nothing is asked.
struct Demand {
  StartBefore start;
  Eigen::VectorXd error;
};

/// One part of the data: what the unknown numbers c contribute to its threshold.
struct ThresholdRows {
  Eigen::MatrixXd filtered;  // a column for each c_k that passes the filter
  // So many of the first rows stand before the part: where earlier starts reach back to.
  Eigen::Index history = 0;
  // Above 0: one more number, at the end of c, adds this times itself in every row, from the start
  // of a run on.
  double constant = 0;
  // A run starts where the largest of the c_k would have brought it (EstimatorSpace::kTorque): no
  // linear programme can ask for that, and such starts are only held against its result.
  bool starts_at_largest = false;
  std::vector<Demand> demands;  // of the programme

  [[nodiscard]] Eigen::Index size() const { return filtered.rows() - history; }
  [[nodiscard]] Eigen::Index unknowns() const { return filtered.cols() + (constant > 0 ? 1 : 0); }
  /// What passes the filter, the rows before the part too.
  [[nodiscard]] Eigen::VectorXd along(const Eigen::VectorXd& c) const {
    return filtered * c.head(filtered.cols());
  }
  /// The threshold at the part's rows in runs that start as `start` says, from along(c); 0 in rows
  /// that have no such start.
  [[nodiscard]] Eigen::VectorXd threshold(const StartBefore& start, const Eigen::VectorXd& along,
                                          const Eigen::VectorXd& c) const;
  /// What c is multiplied with for one of these thresholds.
  [[nodiscard]] Eigen::VectorXd row(const StartBefore& start, Eigen::Index at) const;
};

using ThresholdParts = std::vector<std::reference_wrapper<const ThresholdRows>>;

/// The c >= lowest, and <= highest where that is given, whose threshold reaches what every part
/// demands in every row, and has the least mean over the parts' own rows, each number's share in it
/// times its `price`: a linear programme, of which only the rows that matter are ever handed to the
/// solver. Every row of the result holds but for rounding. All entries are >= 0. Throws InputError
/// when the solver finds none (a row without a basis function that could reach its error).
[[nodiscard]] Eigen::VectorXd tightest(const ThresholdParts& parts, const Eigen::VectorXd& lowest,
                                       const Eigen::VectorXd& price,
                                       const std::optional<Eigen::VectorXd>& highest = {});

}  // namespace offnominal::desk
