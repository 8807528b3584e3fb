#pragma once

#include "explain/found_model.hpp"
#include "explain/search_setting.hpp"
#include "explain/sizes.hpp"

namespace offnominal::desk {

// Puts an offset in the place of an effect that was found, where the recordings do not tell from
// nothing what that one has beyond: a spring whose rest is far away, and whose stiffness may be
// none, is an offset. Where that is not significant, neither has a name. One at a time; false where
// there is none. `sizes`: of the accepted, in their order.
bool replace_by_offset(const SearchSetting& setting, const Sizes& sizes, int threads,
                       FoundModel& found);

}  // namespace offnominal::desk
