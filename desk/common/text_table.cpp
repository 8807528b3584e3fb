#include "common/text_table.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace offnominal::desk {

TextTable::TextTable(std::vector<TextColumn> columns, std::string indent, std::string gap)
    : columns_(std::move(columns)), indent_(std::move(indent)), gap_(std::move(gap)) {}

std::string TextTable::heading() const {
  std::vector<std::string> cells;
  for (const TextColumn& column : columns_) cells.push_back(column.heading);
  return line(cells);
}

std::string TextTable::line(const std::vector<std::string>& cells) const {
  std::string text = indent_;
  for (std::size_t i = 0; i < std::min(cells.size(), columns_.size()); ++i) {
    const int width = columns_[i].width;
    if (i > 0) text += gap_;
    text += width < 0 ? fmt::format("{:<{}}", cells[i], -width)
                      : fmt::format("{:>{}}", cells[i], width);
  }
  return text + "\n";
}

}  // namespace offnominal::desk
