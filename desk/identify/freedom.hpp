#pragma once

#include <array>
#include <cstddef>
#include <string>

namespace offnominal::desk {

using Interval = std::array<double, 2>;  // both ends

// What one joint's share of a recording leaves to judge a number by: groups of samples that are
// independent of each other and say something of this joint, and the numbers that they alone have
// to tell. Numbers of other joints, and those that are believed beforehand, take nothing away.
struct Freedom {
  int groups = 0;
  int unknowns = 0;

  [[nodiscard]] int free() const { return groups - unknowns; }
  // With fewer than three free, Student's t is wider than anything that it could tell.
  [[nodiscard]] bool suffices() const { return free() >= kFewestFree; }
  static constexpr int kFewestFree = 3;
};

// Half-width of a two-sided 95 % interval over the standard deviation that groups of samples show:
// Student's t, and what the fit itself has taken out of their spread. `freedom` suffices.
double half_width_per_deviation(const Freedom& freedom);

// Why there is no interval where freedom does not suffice; `joint` counts from 0.
std::string words_of_too_few(const Freedom& freedom, std::size_t joint);

}  // namespace offnominal::desk
