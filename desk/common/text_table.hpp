#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

namespace offnominal::desk {

/// A column of a table for terminals. `width`: characters at least; above 0 flush right, below 0
/// flush left, 0 as long as the cell is.
struct TextColumn {
  std::string heading;
  int width = 0;
};

/// Lines of cells under headings, of one width per column.
class TextTable {
 public:
  /// `indent` begins every line, `gap` stands between two cells.
  explicit TextTable(std::vector<TextColumn> columns, std::string indent = {},
                     std::string gap = " ");

  /// The headings as a line, with its end.
  [[nodiscard]] std::string heading() const;

  /// A line of one cell per column, or of the first columns alone, with its end.
  template <typename... Cells>
  [[nodiscard]] std::string row(const Cells&... cells) const {
    return line({fmt::format("{}", cells)...});
  }
  [[nodiscard]] std::string line(const std::vector<std::string>& cells) const;

 private:
  std::vector<TextColumn> columns_;
  std::string indent_;
  std::string gap_;
};

}  // namespace offnominal::desk
