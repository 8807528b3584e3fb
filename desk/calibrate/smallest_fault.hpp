#pragma once

#include <optional>
#include <vector>

#include "calibrate/calibrate.hpp"
#include "calibrate/recorded_error.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

/// Which lasting torque on one joint, beside the model, is seen: N m or N. Both are of faults that
/// appear at once and stay; what the robot's own errors do meanwhile is the difference.
struct SmallestFault {
  /// Seen for certain, whatever these errors do within the bound (docs/theory.md): twice the
  /// largest threshold that the bound can come to, at whatever speed. `certain_with` is a quarter
  /// larger, and seen within certain_s.
  double certain = 0;
  double certain_with = 0;
  double certain_s = 0;
  /// Seen within `window_s` for 95 of 100 beginnings in these recordings, whichever its sign. Half
  /// of such faults twice as large are seen within `twice_s`.
  double usual = 0;
  double window_s = 0;
  double twice_s = 0;
  double soon = 0;  // as `usual`, within FaultWindows::soon_s
};

/// Within which a fault has to be seen, s.
struct FaultWindows {
  std::optional<double> whole_s = {};  // none: five time constants of the filter, which has then
                                       // seen 99 % of a fault
  std::optional<double> soon_s = {};   // none: half of it
};

/// Of one joint with this bound: `recordings`, with residuals, and the bound's thresholds in each.
[[nodiscard]] SmallestFault smallest_fault(const std::vector<RecordedError>& recordings,
                                           const std::vector<Eigen::VectorXd>& thresholds,
                                           const JointBoundSettings& bound, double alpha_per_s,
                                           const FaultWindows& windows = {});

}  // namespace offnominal::desk
