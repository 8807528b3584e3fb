#pragma once

#include "report/page.hpp"

// A monitor's second level, beyond which a controller acts: the same line on every page.

namespace offnominal::desk::report {

inline constexpr const char* kActLevel = "level to act";

/// act_ratio times the threshold, over its x.
[[nodiscard]] inline Series act_level(const Series& threshold, double act_ratio) {
  Series level = threshold;
  level.name = kActLevel;
  level.tone = Tone::kFaint;
  level.dashed = true;
  for (double& value : level.y) value *= act_ratio;
  return level;
}

}  // namespace offnominal::desk::report
