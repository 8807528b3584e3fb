#pragma once

#include <span>
#include <string>
#include <string_view>

namespace offnominal::desk {

/// `word` as it has to be typed for a shell to take it as one word: in single quotes where blanks
/// or characters that a shell has other plans for are in it.
[[nodiscard]] std::string shell_word(std::string_view word);

/// The words side by side, each so.
[[nodiscard]] std::string shell_words(std::span<const std::string> words);

}  // namespace offnominal::desk
