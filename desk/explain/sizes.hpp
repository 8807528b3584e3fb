#pragma once

#include <vector>

#include "explain/found_model.hpp"
#include "identify/estimates.hpp"
#include "identify/improved_robot.hpp"

namespace offnominal::desk {

// The numbers of every effect that was found, with intervals that hold noise, and what the model's
// simplifications do: as far as a number moves in narrower bands counts as one standard deviation
// of that (band_shift.hpp).
struct Sizes {
  std::vector<std::vector<Estimate>> numbers;
  std::vector<double> from_nothing;  // LinearPart::from_nothing(); 0 of a size that cannot be, and
                                     // of a wave whose order or frequency is unknown by half of it
  // What it is linear in, per effect: as it is, and with the regions of narrower bands.
  std::vector<std::vector<LinearPart>> linear = {};
};

Sizes sizes_of(const ImprovedRobot& improved);

// Takes one of the accepted out of the model: its joint is unsure from then on, and one that was
// found alone is suspected.
void leave_out(std::size_t which, const Regression& regression, const HoldOut& hold_out,
               int threads, FoundModel& found);

// Takes back the name whose size the recordings tell least from nothing, one at a time: what goes
// may be what made another unsure. False where all are sure. A shape at the end of what a motion
// resolves (extra friction below its slowest velocity) fits a few stretches closely, beyond what
// chance does, and its size says nothing of the next. Its joint is unsure from then on; one that
// was found alone is suspected, too. `sizes`: of the accepted, in their order.
bool leave_out_unsure(const Sizes& sizes, const Regression& regression, const HoldOut& hold_out,
                      int threads, FoundModel& found);

}  // namespace offnominal::desk
