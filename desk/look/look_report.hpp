#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "look/look.hpp"
#include "report/page.hpp"

namespace offnominal::desk {

// The [channels] that a look proposes, or the robot file's own, ready to be pasted into a robot
// file. It is always TOML; what could not be told stands in comments, and what lacks it is refused
// until somebody says it.
[[nodiscard]] std::string channels_text(const Look& look);

// `command`: the words of the command line, which a page shows.
[[nodiscard]] std::string text_of(const Look& look);
[[nodiscard]] nlohmann::json to_json(const Look& look);
[[nodiscard]] report::Page page_of(const Look& look, const std::string& command);

}  // namespace offnominal::desk
