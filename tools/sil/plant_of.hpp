// The plant's end of the bus, as a scenario describes it.
#pragma once

#include <optional>
#include <vector>

#include "offnominal/sim/bus/plant_node.hpp"
#include "sil/sil.hpp"

namespace offnominal::tools::sil {

/// The scenario with what its faults do to the arm entered into its experiment. Throws InputError
/// for more than one of those that develop.
[[nodiscard]] Scenario with_arm_faults(const Scenario& scenario);

/// Throws InputError for a fault that only a run in lock-step can have: those of the controller's
/// own node.
void check_real_time(const Scenario& scenario);

/// Arm, drives and encoders of a scenario that has gone through with_arm_faults(). The drives'
/// watch-dogs let go after 5 periods without a command.
[[nodiscard]] sim::PlantNode plant_of(const Scenario& complete, double period_s);

[[nodiscard]] hal::Microseconds period_us_of(double period_s);

/// When the first fault begins, s; none where there is none.
[[nodiscard]] std::optional<double> first_begin_s(const std::vector<sim::FaultEvent>& faults);

}  // namespace offnominal::tools::sil
