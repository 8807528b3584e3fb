#pragma once

#include <string>
#include <vector>

#include "explain/explain.hpp"

namespace offnominal::desk {

// Mean square of a joint's error on data that no fit has seen, before and after.
struct HeldOutSquares {
  double before = 0;
  double after = 0;
};

// Those of what explain() held out, per joint.
std::vector<HeldOutSquares> held_out_squares(const Explanation& e);

// Why what was found should not be written, as far as data say that the fit has not seen: a joint
// with a finding must gain, no other may lose more than what a twentieth is. One sentence each.
std::vector<std::string> doubts_of(const Explanation& e, const std::vector<HeldOutSquares>& joints);

// By what explain() held out; none where nothing was found, nor of hold maps, which it does not
// hold out so.
std::vector<std::string> doubts_of(const Explanation& e);

}  // namespace offnominal::desk
