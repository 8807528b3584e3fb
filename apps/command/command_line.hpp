#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "common/shell_word.hpp"

namespace offnominal::desk {

/// The options of a verb, or of a program without verbs, that the user gave, as they would be typed
/// again; pages show it.
[[nodiscard]] inline std::string command_line_of(const CLI::App& verb) {
  const CLI::App* program = verb.get_parent();
  std::string line = (program == nullptr ? "" : program->get_name() + " ") + verb.get_name();
  for (const CLI::Option* option : verb.get_options()) {
    if (option->count() == 0) continue;
    if (!option->get_positional()) line += " " + option->get_name();
    if (option->get_items_expected_max() == 0) continue;  // a flag
    for (const std::string& word : option->results()) line += " " + shell_word(word);
  }
  return line;
}

}  // namespace offnominal::desk
