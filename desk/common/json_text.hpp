#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace offnominal::desk {

/// A JSON object as programs print it, indented, its line's end included. Bytes that are no UTF-8,
/// of a file's name, become U+FFFD.
template <typename Json>
[[nodiscard]] std::string json_text(const Json& value) {
  return value.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

/// The text with what is no UTF-8 in it replaced by U+FFFD, as TOML and JSON want it.
[[nodiscard]] inline std::string as_utf8(const std::string& text) {
  const nlohmann::json value = text;
  return nlohmann::json::parse(value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace))
      .get<std::string>();
}

}  // namespace offnominal::desk
