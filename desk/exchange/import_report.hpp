#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "exchange/import_urdf.hpp"

namespace offnominal::desk::exchange {

/// The robot as a file's text, with what was merged, held, left out and assumed as comments.
[[nodiscard]] std::string robot_text_of(const ImportedRobot& imported, const std::string& file);

/// What was read, a row per joint, and a line per note.
[[nodiscard]] std::string text_of(const ImportedRobot& imported);
[[nodiscard]] nlohmann::ordered_json to_json(const ImportedRobot& imported);

}  // namespace offnominal::desk::exchange
