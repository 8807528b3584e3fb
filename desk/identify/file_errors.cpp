#include "identify/file_errors.hpp"

#include <utility>

#include "compare/compare.hpp"

namespace offnominal::desk {

FileErrors file_errors(const RobotDescription& robot, const std::vector<Log>& logs,
                       const FilterPlan& plan) {
  std::vector<Comparison> recordings;
  for (const Log& log : logs)
    recordings.push_back(compare(robot, measure(held_elsewhere(log), robot, plan)));
  FileErrors errors;
  for (const JointComparison& joint : together(std::move(recordings)).joints) {
    errors.rms_error.push_back(joint.rms_error);
    errors.rms_torque.push_back(joint.rms_torque);
  }
  return errors;
}

}  // namespace offnominal::desk
