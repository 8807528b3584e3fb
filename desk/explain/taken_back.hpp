#pragma once

#include "explain/as_written.hpp"
#include "explain/found_model.hpp"
#include "explain/search_setting.hpp"

// Names that the file they would be written to speaks against. One is taken back at a time; false
// where none is.

namespace offnominal::desk {

// Of a joint that the new file leaves worse than the one that was read: then nothing shows it.
// Friction that every drive has is there all the same, and what is carried need not show on its own
// joint. Not of readings at rest, which have no file.
bool takes_back_what_raises(const Judged& by, const ImprovedRobot& improved,
                            const SearchSetting& setting, int threads, FoundModel& found);

// Of friction that all together drives its joint: what is less than plain friction is none, and
// which of the family comes closest to it says nothing.
bool takes_back_what_drives(const ImprovedRobot& improved, const SearchSetting& setting,
                            int threads, FoundModel& found);

}  // namespace offnominal::desk
