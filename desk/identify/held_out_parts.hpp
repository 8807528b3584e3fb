#pragma once

#include <vector>

#include "identify/rows.hpp"

namespace offnominal::desk {

inline constexpr int kHeldOutParts = 5;

// Which of the parts that are held out in turn each row belongs to, from 0: contiguous pieces of
// two seconds, dealt out one by one.
std::vector<int> held_out_parts(const RowLayout& layout);

}  // namespace offnominal::desk
