#pragma once

#include <vector>

#include "goal.hpp"
#include "summary.hpp"

namespace offnominal::bench {

// Those whose groups were run.
std::vector<Goal> goals_of(const std::vector<Summary>& lines);

}  // namespace offnominal::bench
