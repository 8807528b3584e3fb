#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "offnominal/sim/hidden/request.hpp"

namespace offnominal::bench {

// Cases that are judged by the same numbers.
struct CaseGroup {
  enum class Kind { kEffects, kNone, kOutside, kDataFault, kMotion };
  std::string name;   // for --cases
  std::string words;  // for the table
  Kind kind = Kind::kEffects;
  bool with_baselines = false;
  std::vector<sim::hidden::Request> requests;
};

// All groups in the order of the table. Every case has a seed of its own, made from the base seed,
// the group's name and the case's number: neither other groups nor --quick move it.
std::vector<CaseGroup> case_groups(std::uint64_t base_seed, bool quick);

}  // namespace offnominal::bench
