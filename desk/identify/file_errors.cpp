#include "identify/file_errors.hpp"

#include <cmath>

#include "compare/compare.hpp"

namespace offnominal::desk {

FileErrors file_errors(const RobotDescription& robot, const std::vector<Log>& logs,
                       const FilterPlan& plan) {
  FileErrors all{std::vector<double>(robot.joints.size(), 0),
                 std::vector<double>(robot.joints.size(), 0)};
  std::vector<double> samples(robot.joints.size(), 0);
  for (const Log& log : logs) {
    const Measurement measured = measure(log, robot, plan);
    const Comparison comparison = compare(robot, measured);
    for (const JointComparison& joint : comparison.joints) {
      const double count = measured.moving.col(static_cast<Eigen::Index>(joint.joint)).sum();
      samples[joint.joint] += count;
      all.rms_error[joint.joint] += count * joint.rms_error * joint.rms_error;
      all.rms_torque[joint.joint] += count * joint.rms_torque * joint.rms_torque;
    }
  }
  for (std::size_t joint = 0; joint < samples.size(); ++joint) {
    all.rms_error[joint] = std::sqrt(all.rms_error[joint] / samples[joint]);
    all.rms_torque[joint] = std::sqrt(all.rms_torque[joint] / samples[joint]);
  }
  return all;
}

}  // namespace offnominal::desk
