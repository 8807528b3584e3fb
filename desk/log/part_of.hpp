#pragma once

#include <vector>

#include "log/log.hpp"

namespace offnominal::desk {

// Some samples of a recording as one of its own. What is left out of it beyond its ends keeps its
// place, for what a filter spreads of it.
Log part_of(const Log& log, const RowSpan& samples);

// The parts of `shortest_s` and more in which nothing is left out of any joint; the recording
// itself where that is all of it.
std::vector<Log> untouched_parts(const Log& log, double shortest_s);

}  // namespace offnominal::desk
