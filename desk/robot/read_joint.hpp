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
/// accepts it. The keys of the link that are missing and may be blanks go to `blanks`.
[[nodiscard]] RobotJoint read_joint(const TomlTable& table, std::vector<std::string>& blanks);

/// Refuses the first blank of a joint's table, `others` being how many more the file has.
[[noreturn]] void refuse_blank(const TomlTable& joint, const std::string& key, std::size_t others);

}  // namespace offnominal::desk
