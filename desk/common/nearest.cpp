#include "common/nearest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "common/small_letters.hpp"

namespace offnominal::desk {
namespace {

// Levenshtein distance, one row of the table at a time.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced =
          diagonal + (in_small_letter(a[i - 1]) == in_small_letter(b[j - 1]) ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

std::size_t most_changes(std::size_t length) {
  return length < 4 ? 1 : std::max<std::size_t>(2, length / 3);
}

}  // namespace

std::string nearest(std::string_view word, std::span<const std::string> candidates) {
  std::string best;
  std::size_t best_distance = 0;
  for (const std::string& candidate : candidates) {
    const std::size_t candidate_distance = distance(word, candidate);
    if (candidate_distance > most_changes(candidate.size())) continue;
    if (best.empty() || candidate_distance < best_distance) {
      best = candidate;
      best_distance = candidate_distance;
    }
  }
  return best;
}

std::string list_of(std::span<const std::string> words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

std::string choice_of(std::span<const std::string> words) {
  if (words.size() < 2) return list_of(words);
  return list_of(words.first(words.size() - 1)) + " or " + words.back();
}

}  // namespace offnominal::desk
