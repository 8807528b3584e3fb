// Faults of the log. The robot's motion does not know of them.
#pragma once

#include <array>
#include <vector>

#include "offnominal/sim/hidden/case.hpp"
#include "offnominal/sim/hidden/draws.hpp"

namespace offnominal::sim::hidden {

/// What exactly is wrong with every log of one robot.
struct LogFault {
  DataFault kind = DataFault::kNone;
  std::array<bool, 2> swapped = {false, false};  ///< torque signs
  bool stale_q = false, stale_tau = false;       ///< which channels freeze
  double stale_share = 0.0;                      ///< of the rows
  double skew_s = 0.0;                           ///< torques are logged this much late
  double clock_rate = 1.0;                       ///< of the torque clock against the position's
};

LogFault draw_log_fault(DataFault kind, Draws draws);

/// In the words of Truth::fault_parameters.
std::vector<TrueParameter> parameters(const LogFault& fault);

/// The log with its fault. `draws` places the stale bursts. Where the torque channel would have to
/// come from outside of the recording, its first or last value stands.
Recording with_fault(Recording recording, const LogFault& fault, Draws draws);

}  // namespace offnominal::sim::hidden
