#pragma once

#include <vector>

#include "identify/rows.hpp"

namespace offnominal::desk {

inline constexpr int kHeldOutParts = 5;

// Which of the parts that are held out in turn each row belongs to, from 0: contiguous pieces of
// two seconds, dealt out one by one; of a short recording shorter ones, so that every part has some
// of it, and of a short one among others two at least. `at_rest`: hold maps, whose rows have no
// times.
std::vector<int> held_out_parts(const RowLayout& layout, bool at_rest);

}  // namespace offnominal::desk
