#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "look/look.hpp"
#include "report/page.hpp"

namespace offnominal::desk {

// The [channels] that a look proposes, ready to be pasted into a robot file; what it could not tell
// stands in comments, and in a line that does not read until it is filled in.
[[nodiscard]] std::string channels_text(const Look& look);

// `command`: the words of the command line, which a page shows.
[[nodiscard]] std::string text_of(const Look& look);
[[nodiscard]] nlohmann::json to_json(const Look& look);
[[nodiscard]] report::Page page_of(const Look& look, const std::string& command);

}  // namespace offnominal::desk
