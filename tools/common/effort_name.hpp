#pragma once

#include <string_view>

namespace offnominal::tools {

/// What a number in this unit is called: a force drives a prismatic joint.
[[nodiscard]] constexpr const char* effort_name(std::string_view unit) {
  return unit == "N" ? "force" : "torque";
}

}  // namespace offnominal::tools
