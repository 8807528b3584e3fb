#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "wcet/scenario.hpp"

namespace offnominal::desk::wcet {

struct SearchSettings {
  int evaluations = 2000;  // of candidates, beside the beginnings
  std::uint64_t seed = 1;
};

struct Candidate {
  TickInput input;
  double cost_ns = 0;
};

/// Cost of an input, ns; above 0. Below 0: it cannot be, and is dropped.
using CostOf = std::function<double(const TickInput&)>;

/// A seeded climb: keeps the costliest inputs found so far, changes one of them at a time, and
/// takes the new one in if it costs more than the cheapest kept. The result is sorted, costliest
/// first, and never cheaper than the best beginning. The same seed and the same costs give the same
/// result.
[[nodiscard]] std::vector<Candidate> search_worst(
    const std::vector<TickInput>& beginnings, const CostOf& cost_of,
    const std::function<TickInput(const TickInput&, std::mt19937_64&)>& change,
    const SearchSettings& settings);

}  // namespace offnominal::desk::wcet
