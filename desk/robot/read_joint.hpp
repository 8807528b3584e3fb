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

/// Whether the [joint.link] of a [[joint]] has none of its keys, or is not there.
[[nodiscard]] bool is_blank_link(const TomlTable& table);

/// One [[joint]] with its link, limits, encoder and gains; checked so that the core's validate()
/// accepts it. `may_be_blank`: a blank link is left as a Joint has it by default.
[[nodiscard]] RobotJoint read_joint(const TomlTable& table, bool may_be_blank = false);

}  // namespace offnominal::desk
