#pragma once

#include <span>
#include <string>
#include <string_view>

namespace offnominal::tools {

/// The candidate that `word` was most likely meant to be: the one with the fewest changed, added
/// or left-out letters, case aside. Empty when even that one needs more than a third of its letters
/// changed (more than two, in a word of four to eight; more than one, in a shorter one), so that a
/// far-fetched guess is never made.
[[nodiscard]] std::string nearest(std::string_view word, std::span<const std::string> candidates);

/// "a, b, c"
[[nodiscard]] std::string list_of(std::span<const std::string> words);

/// "a, b or c"
[[nodiscard]] std::string choice_of(std::span<const std::string> words);

}  // namespace offnominal::tools
