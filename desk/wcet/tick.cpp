#include "wcet/tick.hpp"

#include <string>

#include "common/error.hpp"
#include "common/nearest.hpp"
#include "robot/robot_file.hpp"
#include "wcet/tick_sizes.hpp"

namespace offnominal::desk::wcet {
namespace {

// The smallest controller that holds the robot's.
const TickSize* size_for(const RobotDescription& robot) {
  const TickSize* best = nullptr;
  for (const TickSize& size : tick_sizes()) {
    const bool holds =
        size.joints == robot.joint_count() && size.hidden_units >= robot.estimator.hidden_units;
    if (holds && (best == nullptr || size.hidden_units < best->hidden_units)) best = &size;
  }
  return best;
}

std::string sizes_words() {
  return list_of(tick_sizes(), [](const TickSize& size) {
    return std::to_string(size.joints) + "x" + std::to_string(size.hidden_units);
  });
}

}  // namespace

std::unique_ptr<Tick> make_tick(const RobotDescription& robot, Precision precision,
                                hal::FrameFormat format) {
  require_bound(robot, "robot " + robot.name);
  const TickSize* size = size_for(robot);
  if (size == nullptr) {
    throw InputError(
        {.file = "robot " + robot.name,
         .place = "joints x hidden units",
         .found = std::to_string(robot.joint_count()) + "x" +
                  std::to_string(robot.estimator.hidden_units),
         .allowed = "at most what this build has: " + sizes_words(),
         .mend = "build with -DOFFNOMINAL_WCET_SIZES=" + std::to_string(robot.joint_count()) + "x" +
                 std::to_string(robot.estimator.hidden_units)});
  }
  const bool by_joint = robot.estimator.space == EstimatorSpace::kTorque;
  return (by_joint ? size->make_in_torque_space : size->make)(robot, precision, format);
}

}  // namespace offnominal::desk::wcet
