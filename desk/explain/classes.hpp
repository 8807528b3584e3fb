#pragma once

#include <vector>

#include "explain/excitation.hpp"
#include "explain/explain.hpp"
#include "explain/found_model.hpp"
#include "explain/search_setting.hpp"

namespace offnominal::desk {

// What each effect that was found could just as well be, where there is anything. A later, smaller
// one that as many others explain as well has no name: it is left to the remainder. `excitation`:
// per joint.
std::vector<std::vector<EffectAt>> classes_of(const SearchSetting& setting,
                                              const std::vector<Excitation>& excitation,
                                              FoundModel& found);

}  // namespace offnominal::desk
