#pragma once

#include <optional>
#include <string>
#include <vector>

namespace offnominal::desk {

/// A key of [estimator] with its new value, as it stands in the file, and why: a comment behind it.
struct EstimatorLine {
  std::string key;
  std::string value;
  std::string reason;
};

/// `old_text`, a robot file, with these keys of [estimator] in place of its own: each in its old
/// line, or behind the last of the table, or in a table of their own behind the last line. Every
/// other line stays. None where the text is no robot file, where the table is written in a way that
/// cannot be changed by lines ({...} or dotted keys).
[[nodiscard]] std::optional<std::string> text_with_estimator(
    const std::string& old_text, const std::vector<EstimatorLine>& lines);

}  // namespace offnominal::desk
