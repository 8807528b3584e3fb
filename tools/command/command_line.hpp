#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "common/shell_word.hpp"

namespace offnominal::tools {

/// The options of a verb that the user gave, as they would be typed again; pages show it.
[[nodiscard]] inline std::string command_line_of(const CLI::App& verb) {
  std::string line = "offnominal " + verb.get_name();
  for (const CLI::Option* option : verb.get_options()) {
    if (option->count() == 0) continue;
    if (!option->get_positional()) line += " " + option->get_name();
    if (option->get_items_expected_max() == 0) continue;  // a flag
    for (const std::string& word : option->results()) line += " " + shell_word(word);
  }
  return line;
}

}  // namespace offnominal::tools
