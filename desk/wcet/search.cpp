#include "wcet/search.hpp"

#include <algorithm>
#include <cstddef>

namespace offnominal::desk::wcet {

std::vector<Candidate> search_worst(
    const std::vector<TickInput>& beginnings, const CostOf& cost_of,
    const std::function<TickInput(const TickInput&, std::mt19937_64&)>& change,
    const SearchSettings& settings) {
  constexpr std::size_t kKept = 8;
  std::mt19937_64 generator(settings.seed);
  std::vector<Candidate> kept;
  const auto offer = [&kept, &cost_of](const TickInput& input) {
    Candidate candidate{input, cost_of(input)};
    if (candidate.cost_ns < 0) return;
    const auto place = std::find_if(kept.begin(), kept.end(), [&](const Candidate& other) {
      return candidate.cost_ns > other.cost_ns;
    });
    kept.insert(place, std::move(candidate));
    if (kept.size() > kKept) kept.pop_back();
  };
  for (const TickInput& input : beginnings) offer(input);
  for (int i = 0; i < settings.evaluations && !kept.empty(); ++i) {
    std::uniform_int_distribution<std::size_t> which(0, kept.size() - 1);
    offer(change(kept[which(generator)].input, generator));
  }
  return kept;
}

}  // namespace offnominal::desk::wcet
