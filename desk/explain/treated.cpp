#include "explain/treated.hpp"

#include <fmt/format.h>

#include <utility>

#include "common/error.hpp"
#include "compare/measurement.hpp"
#include "explain/treatment.hpp"
#include "log/seen_by_sensor.hpp"

namespace offnominal::desk {
namespace {

void check_joints(const std::vector<Log>& logs, const RobotDescription& robot) {
  for (const Log& log : logs) require_joints(log, robot);
}

void check_keep(const std::vector<KeepFault>& keep, const RobotDescription& robot) {
  for (const KeepFault& one : keep) {
    if (one.joint < 0) continue;
    const std::string said = fmt::format("{}:{}", one.joint + 1, name_of(one.kind));
    if (one.joint >= robot.joint_count()) {
      throw InputError({"--keep", "", said,
                        fmt::format("one of the joints 1 to {} of robot {}, or all",
                                    robot.joint_count(), robot.name),
                        ""});
    }
    if (one.kind == DataFaultKind::kGaps || one.kind == DataFaultKind::kTimeUnit ||
        one.kind == DataFaultKind::kJointOrder || one.kind == DataFaultKind::kJointZero) {
      throw InputError({"--keep", "", said, "a fault of one joint: this one is of all",
                        fmt::format("write all:{}", name_of(one.kind))});
    }
  }
}

}  // namespace

std::vector<DataFault> treat_all(const std::vector<std::span<Log>>& groups,
                                 const RobotDescription& robot,
                                 const std::vector<KeepFault>& keep) {
  check_keep(keep, robot);
  std::vector<DataFault> all;
  for (const std::span<Log> group : groups) {
    for (Log& log : group) {
      if (log.at_rest) continue;
      for (DataFault& fault : treat(log, robot, keep)) all.push_back(std::move(fault));
    }
  }
  return all;
}

Treated treated(const RobotDescription& robot, std::vector<Log> logs, std::vector<Log> holdout,
                const std::vector<KeepFault>& keep) {
  check_joints(logs, robot);
  check_joints(holdout, robot);
  for (const auto* recordings : {&logs, &holdout}) {
    for (const Log& log : *recordings) refuse_hidden_from_sensors(robot, log);
  }
  Treated all{std::move(logs), std::move(holdout), {}};
  all.faults = treat_all({all.logs, all.holdout}, robot, keep);
  return all;
}

}  // namespace offnominal::desk
