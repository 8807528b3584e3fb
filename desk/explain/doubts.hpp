#pragma once

#include <string>
#include <vector>

#include "explain/explain.hpp"

namespace offnominal::desk {

// Mean square of a joint's error on data that no fit has seen, before and after, and of its torque.
struct HeldOutSquares {
  double before = 0;
  double after = 0;
  double torque = 0;
};

// Those of what explain() held out, per joint.
std::vector<HeldOutSquares> held_out_squares(const Explanation& e);

// Whether data that no fit has seen speak against a change: a joint that is changed itself must
// gain, at no other may it rise (before_after.hpp). Of a mass one of those that carry it must gain.
bool is_doubted(const HeldOutSquares& joint, bool is_changed);

// Why what was found should not be written, as far as data say that the fit has not seen. One
// sentence each.
std::vector<std::string> doubts_of(const Explanation& e, const std::vector<HeldOutSquares>& joints);

// By what explain() held out; none where nothing was found, nor of hold maps, which it does not
// hold out so.
std::vector<std::string> doubts_of(const Explanation& e);

}  // namespace offnominal::desk
