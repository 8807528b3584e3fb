#pragma once

#include <string>
#include <vector>

#include "common/toml_table.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

/// The keys of one [[joint]].
[[nodiscard]] const std::vector<std::string>& joint_keys();

inline constexpr int kMaxEncoderBits = 32;

/// Counts per rad of an encoder with 2^bits counts per turn.
[[nodiscard]] double counts_per_rad(int bits);

/// One [[joint]] with its link, limits, encoder and gains; checked so that the core's validate()
/// accepts it.
[[nodiscard]] RobotJoint read_joint(const TomlTable& table);

}  // namespace offnominal::desk
