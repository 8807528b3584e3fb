#pragma once

#include <cstdint>
#include <string_view>

namespace offnominal::bench {

// G. Steele, D. Lea, C. Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014.
constexpr std::uint64_t split_mix(std::uint64_t state) {
  state += 0x9e3779b97f4a7c15U;
  state = (state ^ (state >> 30U)) * 0xbf58476d1ce4e5b9U;
  state = (state ^ (state >> 27U)) * 0x94d049bb133111ebU;
  return state ^ (state >> 31U);
}

// Of case `number` of a group: neither other groups nor other numbers move it. Below 2^32: a seed
// is typed and read by people.
constexpr std::uint64_t case_seed(std::uint64_t base, std::string_view group, int number) {
  std::uint64_t seed = split_mix(base);
  for (const char letter : group) seed = split_mix(seed ^ static_cast<unsigned char>(letter));
  return split_mix(seed + static_cast<std::uint64_t>(number)) >> 32U;
}

}  // namespace offnominal::bench
