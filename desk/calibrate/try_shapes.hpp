#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "calibrate/calibrate.hpp"
#include "calibrate/recorded_error.hpp"
#include "calibrate/shape_fit.hpp"
#include "calibrate/split.hpp"

// Every shape of bound, fitted, and widened by what it meets on parts that it has not seen.

namespace offnominal::desk {

/// Recordings, and which parts of them are calibrated on.
struct CalibrationData {
  std::vector<RecordedError> recordings;
  Split split;
  double block_s = 0;
  std::optional<int> joint;  // from 0; the recordings' errors are of this one alone
  std::size_t judged = 1;    // how many errors are judged in all: joints, or 1

  [[nodiscard]] std::int64_t block_samples(const RecordedError& recording) const {
    return std::max<std::int64_t>(1, std::llround(block_s / recording.period_s));
  }
};

/// One shape with its widening.
struct Tried {
  BoundShape shape;
  ShapeFit fit;
  std::vector<double> maxima;  // of the unseen ratio, per block
  ExtremeLaw law;
  double largest = 0;
  double widening = 1;
  double act_ratio = 1;  // of the second level to the first
  double mean_threshold = 0;
  // By which shapes are compared: the mean threshold; of one joint, whose table is high for the
  // moments of a reversal, the typical one, which says what is seen in between.
  double judged_threshold = 0;
};

/// Constant first. A transient is not among what the widening is for (Transient).
struct Tries {
  std::vector<Tried> shapes;
  std::optional<Transient> transient;
};

[[nodiscard]] Tries try_shapes(const RobotDescription& robot, const CalibrationData& data,
                               const CalibrateRequest& request,
                               const std::function<void()>& on_step);

/// The best of each kind in turn, from the simplest on: constant, scaled_norm, table.
[[nodiscard]] std::size_t choice_among(const std::vector<Tried>& tried);

}  // namespace offnominal::desk
