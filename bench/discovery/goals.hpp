#pragma once

#include <string>
#include <vector>

#include "summary.hpp"

namespace offnominal::bench {

// A number of the project's list of numbers to reach, and what was measured.
struct Goal {
  std::string what;
  std::string wanted;
  std::string measured;
  bool reached = false;
};

// Those whose groups were run.
std::vector<Goal> goals_of(const std::vector<Summary>& lines);

}  // namespace offnominal::bench
