#pragma once

#include <Eigen/Core>

#include "explain/doctor_signal.hpp"
#include "explain/expected_torque.hpp"
#include "log/log.hpp"

namespace offnominal::desk {

enum class MovedMeanwhile { kNo, kYes, kUnknown };

// Whether the joint of a position that repeats, then jumps, moved meanwhile or is counted from
// another zero, by the torques: as far as they leave the model between the beginning of the burst
// and its end, the joint moved. Unknown where no torque tells the position before the jump from the
// one behind it.
MovedMeanwhile moved_meanwhile(const Log& log, const Burst& burst, const ExpectedTorque& expected);

}  // namespace offnominal::desk
