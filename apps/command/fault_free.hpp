#pragma once

#include <string>
#include <vector>

#include "command/doctor.hpp"
#include "command/progress.hpp"
#include "command/recordings.hpp"

namespace offnominal::desk {

// Recordings of the healthy robot, for verbs that take what is in them for what the monitor has to
// bear.
struct FaultFree {
  std::vector<DataFault> faults;  // of the recordings, not of the robot
  std::string left_out;           // what they took of the recordings to fit to; empty: nothing
};

// Leaves in `data` what is no fault of the recording, in parts of 2 s and more, and holds the last
// recording out, or the last fifth of a single one, where none is. Says on stderr what is left out,
// but for `keep`. Throws InputError where a recording has nothing left, or a fault with which every
// answer would be wrong.
FaultFree keep_fault_free(FitData& data, const std::vector<KeepFault>& keep, Progress& progress);

}  // namespace offnominal::desk
