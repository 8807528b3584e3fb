#include "campaign/campaign.hpp"

#include <charconv>
#include <cmath>

#include "common/error.hpp"

namespace offnominal::desk::campaign {

int Campaign::fault_free_runs() const {
  return static_cast<int>(
      std::ceil(runs.fault_free_hours * 3600 / runs.fault_free_duration_s - 1e-9));
}

std::int64_t Campaign::run_count() const {
  return static_cast<std::int64_t>(faults.size()) * runs.per_fault + fault_free_runs();
}

Run run_of(const Campaign& campaign, std::int64_t number) {
  const auto of_faults =
      static_cast<std::int64_t>(campaign.faults.size()) * campaign.runs.per_fault;
  if (number >= of_faults) return {number, nullptr, campaign.runs.fault_free_duration_s};
  const auto fault = static_cast<std::size_t>(number / campaign.runs.per_fault);
  return {number, &campaign.faults[fault], campaign.runs.duration_s};
}

std::vector<std::int64_t> runs_of(const Campaign& campaign, const Shard& shard) {
  std::vector<std::int64_t> numbers;
  const std::int64_t count = campaign.run_count();
  for (std::int64_t i = shard.index - 1; i < count; i += shard.count) numbers.push_back(i);
  return numbers;
}

Shard parse_shard(const std::string& text) {
  constexpr std::int64_t kMost = 1'000'000;
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, shard.index);
  const bool has_slash = first.ec == std::errc{} && first.ptr != end && *first.ptr == '/';
  if (has_slash) {
    const auto second = std::from_chars(first.ptr + 1, end, shard.count);
    const bool whole = second.ec == std::errc{} && second.ptr == end;
    if (whole && shard.index >= 1 && shard.index <= shard.count && shard.count <= kMost) {
      return shard;
    }
  }
  throw InputError({.file = "--shard",
                    .place = "",
                    .found = text,
                    .allowed = "i/n with 1 <= i <= n <= 1000000, as 3/8",
                    .mend = "give every one of n processes a number of its own"});
}

}  // namespace offnominal::desk::campaign
