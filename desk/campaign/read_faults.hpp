#pragma once

#include <vector>

#include "campaign/campaign.hpp"
#include "common/toml_table.hpp"

namespace offnominal::desk::campaign {

/// Every [[fault]] of a campaign file, one fault for each of its sizes and joints. Of `campaign`
/// plant and robot have to be there. Throws InputError.
[[nodiscard]] std::vector<Fault> read_faults(const TomlTable& root, const toml::table& document,
                                             const Campaign& campaign);

/// Coulomb friction that a robot file gives a joint (from 0), N m.
[[nodiscard]] double own_friction_nm(const RobotDescription& robot, int joint);

}  // namespace offnominal::desk::campaign
