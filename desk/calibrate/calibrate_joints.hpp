#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/calibrate.hpp"
#include "calibrate/smallest_fault.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

// The bounds of a robot that is watched joint by joint (EstimatorSpace::kTorque).

namespace offnominal::desk {

/// One joint: the same as of |e| where there is one bound of all, of that joint's residual, in N m
/// or N. The rate that it is calibrated for is its share of the whole.
struct JointCalibration {
  std::string name;
  Calibration calibration;  // its robot means nothing
  SmallestFault fault;
};

struct JointsCalibration {
  RobotDescription robot;  // with the new bounds
  std::optional<BoundSettings> old_bound;
  double alarms_per_hour = 0;                      // of all joints and filters together
  std::optional<double> act_alarms_per_hour = {};  // of the second level; none: there is one
  std::vector<JointCalibration> joints;
  std::vector<JointCalibration> fast;  // the same behind the fast filter; empty: the robot has none
  std::vector<std::string> notes;
  std::vector<std::string> objections;  // why the result must not be used; empty: it may
};

/// "600 blocks of 5 s", whose maxima the laws were fitted to: each filter has blocks of its own
/// length.
[[nodiscard]] std::string blocks_words(const JointsCalibration& calibration);

/// As calibrate(), joint by joint, for a robot whose estimator is in EstimatorSpace::kTorque. The
/// rate is shared evenly: alarms of different joints, and of a joint's two filters, are taken for
/// different alarms, which is on the safe side. Throws InputError too where a velocity error is
/// given, which says nothing of torques.
[[nodiscard]] JointsCalibration calibrate_joints(const RobotDescription& robot,
                                                 const CalibrateRequest& request,
                                                 const std::vector<Log>& logs,
                                                 const std::vector<Log>& holdout,
                                                 const std::function<void()>& on_step = {});

}  // namespace offnominal::desk
