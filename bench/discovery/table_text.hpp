#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "rate.hpp"

namespace offnominal::bench {

// A cell of a table: "-" where nothing was counted.
inline std::string percent(const Rate& rate) {
  return rate.of > 0 ? fmt::format("{:.1f}", rate.percent()) : "-";
}

// Most frequent first, then by name.
inline std::string histogram(const std::map<std::string, int>& counts) {
  std::vector<std::pair<std::string, int>> sorted(counts.begin(), counts.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  std::string text;
  for (const auto& [name, count] : sorted) {
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, count);
  }
  return text;
}

}  // namespace offnominal::bench
