#pragma once

#include <vector>

#include "identify/data.hpp"

namespace offnominal::desk {

// Ways to group a regression's rows by what their joint does at that instant, in equally filled
// bins of each joint's own: by velocity before and after a reversal, by position, by load.
std::vector<RowLayout::Blocks> regimes_of(const Data& data);

}  // namespace offnominal::desk
