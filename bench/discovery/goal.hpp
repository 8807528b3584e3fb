#pragma once

#include <string>
#include <vector>

namespace offnominal::bench {

// A number of the project's list of numbers to reach, and what was measured.
struct Goal {
  std::string what;
  std::string wanted;
  std::string measured;
  bool reached = false;
};

// A Markdown table.
std::string table_of(const std::vector<Goal>& goals);

}  // namespace offnominal::bench
