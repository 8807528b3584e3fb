#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>

#include "studio/workbench.hpp"

namespace offnominal::desk::studio {

/// What docs/studio.md calls the state: robot, recordings, joints with their errors, steps, effects
/// of every joint, and what is said of the recordings. What saving would write, the session says.
/// Joints count from 1. A number that there is not is null.
nlohmann::ordered_json state_of(const Workbench& bench);

nlohmann::ordered_json number_or_null(double value);

}  // namespace offnominal::desk::studio
