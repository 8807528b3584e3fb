#pragma once

#include <span>
#include <vector>

#include "explain/data_fault.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// treat() of all of them; readings at rest are left as they are: every check there is needs time.
// Throws InputError, in the name of --keep, where `keep` speaks of a joint that the robot does not
// have, or of one joint's fault that is always of all.
std::vector<DataFault> treat_all(const std::vector<std::span<Log>>& groups,
                                 const RobotDescription& robot, const std::vector<KeepFault>& keep);

// Recordings of which the doctor has left out what is at fault.
struct Treated {
  std::vector<Log> logs;
  std::vector<Log> holdout;
  std::vector<DataFault> faults;
};
// Throws InputError where the recordings and the robot do not fit together.
Treated treated(const RobotDescription& robot, std::vector<Log> logs, std::vector<Log> holdout,
                const std::vector<KeepFault>& keep);

}  // namespace offnominal::desk
