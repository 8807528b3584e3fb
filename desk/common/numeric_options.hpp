#pragma once

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdlib>
#include <string>

#include "common/error.hpp"

namespace offnominal::desk {

/// A number above 0, in words that a user can read: CLI11's own has all digits of the largest.
inline CLI::Validator above_zero() {
  return {[](const std::string& word) {
            const double value = std::strtod(word.c_str(), nullptr);
            return value > 0 && std::isfinite(value) ? "" : word + " is no number above 0";
          },
          "> 0"};
}

/// What CLI11 lets pass: a number that is none is in any range. Throws InputError.
inline void check_numbers(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_type_name().find("FLOAT") == std::string::npos) continue;
    for (const std::string& word : option->results()) {
      if (!std::isnan(std::strtod(word.c_str(), nullptr))) continue;
      const CLI::App* program = app.get_parent();
      const std::string name = program == nullptr ? "" : program->get_name() + " ";
      throw InputError({name + app.get_name(), option->get_name(), word, "a number", ""});
    }
  }
}

}  // namespace offnominal::desk
