#include "log/csv_lines.hpp"

namespace offnominal::desk {

CsvLines CsvLines::next(RecordingFile& file, CsvLayout& layout) {
  CsvLines lines;
  for (const auto& [line, is_ended] : layout.ahead) lines.take(line, is_ended);
  layout.ahead.clear();
  try {
    std::string_view line;
    while (!lines.is_full() && file.next_line(line)) lines.take(line, file.line_ended());
  } catch (...) {
    // Perhaps nobody comes that far.
    lines.error_ = std::current_exception();
  }
  return lines;
}

void CsvLines::take(std::string_view line, bool is_ended) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  lines_.push_back({text_.size(), line.size(), is_ended});
  text_ += line;
}

}  // namespace offnominal::desk
