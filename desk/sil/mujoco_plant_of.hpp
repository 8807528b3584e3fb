// The robot of a MuJoCo file as a plant of a scenario.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "offnominal/sim/plant.hpp"
#include "sil/sil.hpp"

namespace offnominal::desk::sil {

/// "mujoco:": how a file of MuJoCo is told from a robot file where a plant is named.
inline constexpr const char* kMujocoPrefix = "mujoco:";

/// FILE of "mujoco:FILE"; none where that is not what stands there.
[[nodiscard]] std::optional<std::string> mujoco_file_named(const std::string& plant);

/// Throws InputError for a file that MuJoCo does not read, and where its joints do not match those
/// of Scenario::plant: as many, of the same types, in the same order where they have the same
/// names.
void check_mujoco_plant(const Scenario& scenario);

/// Of a scenario that check_mujoco_plant() takes.
[[nodiscard]] std::unique_ptr<sim::Plant> make_mujoco_plant(const Scenario& scenario,
                                                            const sim::JointState& start);

}  // namespace offnominal::desk::sil
