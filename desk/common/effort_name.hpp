#pragma once

#include <string_view>

namespace offnominal::desk {

/// What a number in this unit is called: a force drives a prismatic joint.
[[nodiscard]] constexpr const char* effort_name(std::string_view unit) {
  return unit == "N" ? "force" : "torque";
}

}  // namespace offnominal::desk
