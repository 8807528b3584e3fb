#pragma once

#include <toml++/toml.h>

#include <string>
#include <vector>

#include "drives/drive_settings.hpp"

namespace offnominal::desk {

/// The keys of [drives] beside those of a protocol, which are in drive_protocols().
[[nodiscard]] const std::vector<std::string>& drives_keys();

/// [drives] of a robot with `joint_count` joints that ticks every `period_s`: the keys of its
/// protocol and no others.
[[nodiscard]] DriveSettings read_drives(const toml::table& table, const std::string& file,
                                        int joint_count, double period_s);

}  // namespace offnominal::desk
