#include "calibrate/calibrate.hpp"

#include <utility>

#include "calibrate/calibrate_one.hpp"
#include "calibrate/recorded_error.hpp"

namespace offnominal::desk {

Calibration calibrate(const RobotDescription& robot, const CalibrateRequest& request,
                      const std::vector<Log>& logs, const std::vector<Log>& holdout,
                      const std::function<void()>& on_step) {
  std::vector<RecordedError> recordings;
  for (const auto* group : {&logs, &holdout}) {
    for (const Log& log : *group) recordings.push_back(recorded_error(robot, log));
  }
  const CalibrationData data = data_of(std::move(recordings), logs.size(), {}, 1, request.left_out);
  Fitted fit = fitted(robot, request, data, on_step);
  fit.result.robot.bound->covers_velocities = have_velocities(logs, holdout);
  // The core itself runs over every recording again, with the new bound.
  std::vector<Eigen::VectorXd> thresholds;
  for (const auto* group : {&logs, &holdout}) {
    for (const Log& log : *group) {
      thresholds.push_back(recorded_error(fit.result.robot, log).old_threshold);
    }
  }
  Calibration result = judged_calibration(std::move(fit), request, data, thresholds);
  note_what_matters(robot, data.recordings.size(), result.notes);
  return result;
}

}  // namespace offnominal::desk
