#pragma once

#include "explain/explain.hpp"

namespace offnominal::desk {

// Sets verdict, words and advice from everything else in the explanation.
void judge_whole(Explanation& explanation);

}  // namespace offnominal::desk
