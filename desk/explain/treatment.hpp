#pragma once

#include <vector>

#include "explain/data_fault.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// examine(), and what is at fault for a stretch is left out of the recording (Log::left_out),
// unless `keep` overrules it: of its joint where it is the torque that is at fault, and where it is
// the position of every joint whose torque depends on that. Over the stretch the signal becomes a
// straight line, so that a filter carries nothing of it further than the samples that go with it.
// Where nothing is left of a joint, or of all, that is a fault of its own, the last in the list.
// The faults say which joints do without them.
std::vector<DataFault> treat(Log& log, const RobotDescription& robot,
                             const std::vector<KeepFault>& keep = {});

// Straight lines over the spans of a fault in the signal that it is of; nothing for saturation,
// which is a torque that was there.
void bridge(const DataFault& fault, Log& log);

}  // namespace offnominal::desk
