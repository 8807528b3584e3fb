// Software-in-the-loop in real time: controller and plant as programs of their own.
#pragma once

#include <optional>
#include <string>

#include "sil/sil.hpp"

namespace offnominal::desk::sil {

struct RealTimeOptions {
  std::string interface;                  // of the kernel, up
  std::optional<std::string> robot_file;  // of the controller; none: the paper's arm
  std::optional<std::string> plant_file;  // that of Scenario::plant; none: the paper's arm
  std::string motion = "paper";           // that of Scenario::motion: paper, sway or a file
  std::optional<std::string> candump;     // every frame that the controller saw
  bool replace_candump = false;
};

/// Starts offnominal-plant and offnominal-controller on the interface, waits for the end of the
/// motion and gathers from what both have recorded what run_in_lock_step() shows. Two runs are
/// never quite the same. Throws InputError where a scenario cannot be run so, and where a program
/// fails.
[[nodiscard]] SilResult run_in_real_time(const RobotDescription& robot, const Scenario& scenario,
                                         const RealTimeOptions& options);

}  // namespace offnominal::desk::sil
