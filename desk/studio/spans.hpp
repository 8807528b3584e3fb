#pragma once

#include <vector>

#include "explain/explain.hpp"
#include "report/page.hpp"
#include "studio/charts.hpp"
#include "studio/workbench.hpp"

namespace offnominal::desk::studio {

/// What holds for a while in the recording that is shown, on the joint that is shown: what the
/// doctor found and where, where the joint stands still, and what a search has found that comes and
/// goes: pushes, changes, and where the error stands out. In the recording's own time.
/// `explanation`: null as long as there is none. Throws as check().
std::vector<report::SpanMark> spans_of(const Workbench& bench, const View& view,
                                       const Explanation* explanation);

}  // namespace offnominal::desk::studio
