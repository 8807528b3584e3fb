#pragma once

#include <string>
#include <vector>

#include "common/toml_table.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

/// The keys of [estimator], [arming] and [uncertainty_bound].
[[nodiscard]] const std::vector<std::string>& estimator_keys();
[[nodiscard]] const std::vector<std::string>& arming_keys();
[[nodiscard]] const std::vector<std::string>& bound_keys();

/// [estimator]; keys that are left out keep their defaults. Checked so that the core's validate()
/// accepts it.
[[nodiscard]] EstimatorSettings read_estimator(const TomlTable& table);

/// [arming] of a robot with `joint_count` joints.
[[nodiscard]] ArmingSettings read_arming(const TomlTable& table, int joint_count);

/// [uncertainty_bound] of a robot with `joint_count` joints. `space` says which kinds are named
/// where there is none; those of the other space are read all the same.
[[nodiscard]] BoundSettings read_bound(const TomlTable& table, int joint_count,
                                       EstimatorSpace space);

}  // namespace offnominal::desk
