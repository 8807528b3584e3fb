#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrate/bound_shape.hpp"
#include "calibrate/recorded_error.hpp"
#include "calibrate/split.hpp"

namespace offnominal::desk {

/// The tightest threshold of one shape over all folds, and how it fares on what it has not seen.
struct ShapeFit {
  Eigen::VectorXd coefficients;  // c_1.., then v
  double mean_threshold = 0;     // over all folds, rad/s or m/s, without the 2 v of a given v
  double typical_threshold = 0;  // the same, geometric: of one that is high for moments, the rest
  // |e| over the threshold that the folds of other turns ask for, sample by sample; one entry per
  // fold. The 2 v of a given v is taken off both. kApart in samples that nothing is fitted to.
  std::vector<Eigen::VectorXd> unseen_ratio;
  // Of one joint's residual: largest of runs that start at any sample of a fold, over the threshold
  // that the folds of other turns ask for.
  double unseen_start_ratio = 0;
  // Largest |e| of the samples apart, along the run or after a start, over the tightest threshold.
  double apart_ratio = 0;
  static constexpr double kApart = -1;

  /// The bound whose threshold is `widening` times this one; a given v is not widened.
  [[nodiscard]] BoundSettings widened(const BoundShape& shape, double widening,
                                      const std::optional<double>& velocity_error) const;
};

/// What the c_k may be.
struct CoefficientRange {
  double lowest = 0;
  double highest = 0;  // of a table's; 0: no limit
};

/// Fits to the folds and to what is always calibrated on, but for the samples `apart` of one fold,
/// where there are some. A `velocity_error` that is given is kept as it is.
[[nodiscard]] ShapeFit fit_shape(const RobotDescription& robot, const BoundShape& shape,
                                 const std::vector<RecordedError>& recordings, const Split& split,
                                 const CoefficientRange& range,
                                 const std::optional<double>& velocity_error,
                                 const std::optional<SampleRange>& apart = {});

}  // namespace offnominal::desk
