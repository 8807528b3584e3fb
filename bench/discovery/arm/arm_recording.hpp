#pragma once

#include <string>
#include <vector>

#include "arm_rig.hpp"
#include "offnominal/sim/hidden/draws.hpp"

namespace offnominal::bench {

// How an owner's software records.
struct ArmLogStyle {
  int every = 1;                 // ticks of 1 ms between two samples
  int bits = 17;                 // of a position per turn
  bool has_five_digits = false;  // positions with five digits in place of the encoder's step
  bool logs_velocity = false;
};

// CSV with the common header. `noise_nm`: standard deviation of each joint's torque.
std::string recording_text(const ArmRun& run, const ArmLogStyle& style,
                           const std::vector<double>& noise_nm, sim::hidden::Draws& noise);

}  // namespace offnominal::bench
