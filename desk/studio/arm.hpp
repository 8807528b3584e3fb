#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "studio/workbench.hpp"

namespace offnominal::desk::studio {

/// That the document of the API allows, and what it is without a word.
inline constexpr std::size_t kMostInstants = 1000;

/// Which instants of the arm are asked for.
struct ArmView {
  std::size_t recording = 0;             // from 0, the fitted ones first
  std::size_t instants = kMostInstants;  // 2 or more
  // The part of the time that is shown, s of the recording's own time; none: all of it.
  std::optional<double> from_s = {};
  std::optional<double> to_s = {};
};

/// The arm of docs/studio.md: what it looks like, and at `instants` samples at most, evenly picked
/// from those shown, where every link is and how well the model meets every joint's torque. Peaks
/// between the picked samples are not in it: the errors over the part that is shown are of all of
/// its samples. Throws Refused where there is no such recording or time.
nlohmann::ordered_json arm_of(const Workbench& bench, const ArmView& view);

}  // namespace offnominal::desk::studio
