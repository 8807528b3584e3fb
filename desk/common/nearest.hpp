#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace offnominal::desk {

/// The candidate that `word` was most likely meant to be: the one with the fewest changed, added
/// or left-out letters, case aside. Empty when even that one needs more than a third of its letters
/// changed (more than two, in a word of four to eight; more than one, in a shorter one), so that a
/// far-fetched guess is never made.
[[nodiscard]] std::string nearest(std::string_view word, std::span<const std::string> candidates);

/// "a, b, c"
[[nodiscard]] std::string list_of(std::span<const std::string> words);

/// The same of anything, by the text that text_of() gives each.
template <typename Items, typename TextOf>
[[nodiscard]] std::string list_of(const Items& items, const TextOf& text_of) {
  std::vector<std::string> words;
  for (const auto& item : items) words.push_back(text_of(item));
  return list_of(words);
}

/// "a, b or c"
[[nodiscard]] std::string choice_of(std::span<const std::string> words);

}  // namespace offnominal::desk
