// The plant's end of the bus, as a scenario describes it.
#pragma once

#include <optional>
#include <vector>

#include "drives/drive_settings.hpp"
#include "offnominal/sim/bus/plant_node.hpp"
#include "sil/sil.hpp"

namespace offnominal::desk::sil {

/// Throws InputError for a fault, a hidden effect or an encoder that the scenario's plant cannot
/// have.
void check_plant(const Scenario& scenario);

/// Throws InputError for a fault that only a run in lock-step can have: those of the controller's
/// own node.
void check_real_time(const Scenario& scenario);

/// Throws InputError for frames or velocities of a scenario that the drives do not send.
void check_drives(const Scenario& scenario, const DriveSettings& drives, double period_s);

/// Plant, drives and encoders of a scenario that check_plant() and check_drives() take.
[[nodiscard]] sim::PlantNode plant_of(const Scenario& scenario, const DriveSettings& drives,
                                      double period_s);

/// Joints of the scenario's plant.
[[nodiscard]] int joint_count_of(const Scenario& scenario);

/// The motion of a run: the scenario's, or else the paper's for its arm and a sway for another.
[[nodiscard]] MotionAt motion_of(const Scenario& scenario);

/// Time of the motion by which a run is judged: the controller's, which begins when it holds the
/// joints. The paper's arm is judged by the time since its brakes opened, as its runs without a bus
/// are.
[[nodiscard]] double judging_time_s(const Scenario& scenario, double plants_s,
                                    double controllers_s);

/// The frames of a run: the scenario's, or else classic ones where they fit into the period.
[[nodiscard]] hal::FrameFormat format_of(const Scenario& scenario, const DriveSettings& drives,
                                         double period_s);

/// When the first fault begins, s; none where there is none.
[[nodiscard]] std::optional<double> first_begin_s(const std::vector<sim::FaultEvent>& faults);

}  // namespace offnominal::desk::sil
