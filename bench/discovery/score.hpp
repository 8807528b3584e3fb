#pragma once

#include <vector>

#include "explain/explain.hpp"

namespace offnominal::bench {

using Effects = std::vector<desk::EffectAt>;

// A verdict against the truth.
struct Score {
  bool first = false;      // the first effect named is a true one
  bool sure = false;       // ... and stands in no class of effects that cannot be told apart
  bool in_class = false;   // every true effect is named or stands in such a class
  bool all_named = false;  // every true effect is named
  // An effect is named that is not true and shares no class with a true one, or a class holds no
  // true effect.
  bool wrong = false;
};

Score score_of(const Effects& truth, const Effects& named, const std::vector<Effects>& classes);

}  // namespace offnominal::bench
