#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/calibrate.hpp"
#include "calibrate/recorded_error.hpp"
#include "calibrate/try_shapes.hpp"

// The steps of a calibration of one error: of |e|, or of one joint's residual.

namespace offnominal::desk {

/// Whether every joint of all these recordings has a velocity of its own: a bound that is
/// calibrated on them holds its error.
[[nodiscard]] bool have_velocities(const std::vector<Log>& logs, const std::vector<Log>& holdout);

/// Of recordings of which the first `given` are to calibrate on. Throws InputError where they are
/// too short, with what was left out of them, or without any error.
[[nodiscard]] CalibrationData data_of(std::vector<RecordedError> recordings, std::size_t given,
                                      std::optional<int> joint = {}, std::size_t judged = 1,
                                      const std::string& left_out = {});

/// The bound, before it is judged.
struct Fitted {
  Tries tries;
  std::size_t chosen = 0;
  Calibration result;  // with everything but stretches, notes and objections
};
[[nodiscard]] Fitted fitted(const RobotDescription& robot, const CalibrateRequest& request,
                            const CalibrationData& data, const std::function<void()>& on_step);

/// Held against the recordings: `thresholds` of each are those of the core with the new bound.
[[nodiscard]] Calibration judged_calibration(Fitted fit, const CalibrateRequest& request,
                                             const CalibrationData& data,
                                             const std::vector<Eigen::VectorXd>& thresholds);

/// What a reader of the numbers has to know of robot and recordings.
void note_what_matters(const RobotDescription& robot, std::size_t recordings,
                       std::vector<std::string>& notes);

}  // namespace offnominal::desk
