#pragma once

#include <functional>
#include <vector>

#include "calibrate/calibrate_joints.hpp"
#include "tune/tune.hpp"

namespace offnominal::desk {

/// Every pole that was tried, and the calibration of the best.
struct AlphaChoice {
  std::vector<AlphaTrial> trials;
  JointsCalibration calibration;
};

/// The pole with which the smallest torques are seen in time. `robot` is in
/// EstimatorSpace::kTorque.
[[nodiscard]] AlphaChoice choose_alpha(const RobotDescription& robot, const TuneRequest& request,
                                       const std::vector<Log>& logs,
                                       const std::vector<Log>& holdout,
                                       const std::function<void()>& on_step);

}  // namespace offnominal::desk
