#pragma once

#include <cstddef>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace offnominal::desk {

// The text of a robot file cut into lines, for changes that leave every other line as it was.
using Lines = std::vector<std::string>;

[[nodiscard]] inline Lines lines_of(const std::string& text) {
  Lines lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// Whether lines end as on Windows, by the first of them.
[[nodiscard]] inline bool has_returns(const std::string& text) {
  const auto end = text.find('\n');
  return end != std::string::npos && end > 0 && text[end - 1] == '\r';
}
[[nodiscard]] inline std::string without_returns(const std::string& text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\r' || i + 1 == text.size() || text[i + 1] != '\n') result += text[i];
  }
  return result;
}
[[nodiscard]] inline std::string with_returns(const std::string& text) {
  std::string result;
  for (const char c : without_returns(text)) {
    if (c == '\n') result += '\r';
    result += c;
  }
  return result;
}

[[nodiscard]] inline std::string_view trimmed(const std::string& line) {
  const auto first = line.find_first_not_of(" \t\r");
  if (first == std::string::npos) return {};
  return std::string_view(line).substr(first);
}

[[nodiscard]] inline bool is_header(const std::string& line) {
  return trimmed(line).starts_with('[');
}
[[nodiscard]] inline bool is_comment(const std::string& line) {
  return trimmed(line).starts_with('#');
}

// A line of its own, or behind a value; a string that holds such a sign is taken for one too.
[[nodiscard]] inline bool has_comments(const std::string& text) {
  for (const std::string& line : lines_of(text)) {
    if (is_comment(line) || line.find(" #") != std::string::npos) return true;
  }
  return false;
}

// Behind the last key of the table whose header stands at `begin`. Comments and blank lines above
// the next header belong to that one.
[[nodiscard]] inline std::size_t end_of_block(const Lines& lines, std::size_t begin) {
  std::size_t next = begin + 1;
  while (next < lines.size() && !is_header(lines[next])) ++next;
  while (next > begin + 1 && (trimmed(lines[next - 1]).empty() || is_comment(lines[next - 1]))) {
    --next;
  }
  return next;
}

// Puts a text together from lines that stay and blocks that are new.
class LineComposer {
 public:
  explicit LineComposer(const Lines& lines) : lines_(lines) {}

  void copy_until(std::size_t end) {
    for (; next_ < end; ++next_) text_ += lines_[next_] + "\n";
  }
  void skip_to(std::size_t line) { next_ = line; }
  void insert(const std::string& block) {
    if (!text_.empty() && !text_.ends_with("\n\n")) text_ += "\n";
    text_ += block;
  }
  // `line`, with its end, in the place of the next.
  void replace_line(const std::string& line) {
    text_ += line;
    ++next_;
  }
  void append(const std::string& lines) { text_ += lines; }
  void blank_line_unless_at_end() {
    if (next_ < lines_.size() && !trimmed(lines_[next_]).empty()) text_ += "\n";
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  const Lines& lines_;
  std::size_t next_ = 0;
  std::string text_;
};

}  // namespace offnominal::desk
