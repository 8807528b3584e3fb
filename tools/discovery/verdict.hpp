#pragma once

#include "discovery/explain.hpp"

namespace offnominal::tools::discovery {

// Sets verdict, words and advice from everything else in the explanation.
void judge_whole(Explanation& explanation);

}  // namespace offnominal::tools::discovery
