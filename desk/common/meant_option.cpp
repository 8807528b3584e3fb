#include "common/meant_option.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <vector>

#include "common/nearest.hpp"

namespace offnominal::desk {
namespace {

std::vector<std::string> option_names(const CLI::App& verb) {
  std::vector<std::string> names;
  for (const CLI::Option* option : verb.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

// The only name that begins with `word`, else the one that looks most like it.
std::string meant_by(const std::string& word, const std::vector<std::string>& names) {
  const auto begins = [&word](const std::string& name) { return name.starts_with(word); };
  if (std::count_if(names.begin(), names.end(), begins) == 1) {
    return *std::find_if(names.begin(), names.end(), begins);
  }
  return nearest(word, names);
}

}  // namespace

std::string meant_option(const CLI::App& verb) {
  const std::vector<std::string> names = option_names(verb);
  for (const std::string& left_over : verb.remaining()) {
    if (!left_over.starts_with("--")) continue;
    const std::string meant = meant_by(left_over.substr(0, left_over.find('=')), names);
    return meant.empty() ? "" : "write " + meant;
  }
  return {};
}

}  // namespace offnominal::desk
