#pragma once

#include <functional>
#include <vector>

#include "calibrate/calibrate_joints.hpp"
#include "tune/tune.hpp"

namespace offnominal::desk {

/// A second filter's pole is so many times as far at least, and what it sees soon is smaller by as
/// much as makes a pole better: otherwise one filter does.
inline constexpr double kFaster = 2;

/// Every pole that was tried, and the calibration of the best.
struct AlphaChoice {
  std::vector<AlphaTrial> trials;
  JointsCalibration calibration;
};

/// The pole with which the smallest torques are seen in time, and beside it, where that is worth a
/// second filter, the one with which they are seen sooner. `robot` is in EstimatorSpace::kTorque.
[[nodiscard]] AlphaChoice choose_alpha(const RobotDescription& robot, const TuneRequest& request,
                                       const std::vector<Log>& logs,
                                       const std::vector<Log>& holdout,
                                       const std::function<void()>& on_step);

}  // namespace offnominal::desk
