#pragma once

#include <cstddef>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include "log/csv_layout.hpp"
#include "log/recording_file.hpp"

namespace offnominal::desk {

// Lines of a file that were read together.
class CsvLines {
 public:
  // About so many bytes are read at once: enough that to begin a thread costs nothing beside them.
  static constexpr std::size_t kBytes = std::size_t{1} << 22;

  // Takes the lines that the layout has read ahead first, and none of them twice.
  static CsvLines next(RecordingFile& file, CsvLayout& layout);

  [[nodiscard]] std::size_t size() const { return lines_.size(); }
  // Without its end, of either kind.
  [[nodiscard]] std::string_view line(std::size_t i) const {
    return std::string_view(text_).substr(lines_[i].first, lines_[i].length);
  }
  // Whether its end was there: only the last of a file may lack it.
  [[nodiscard]] bool is_ended(std::size_t i) const { return lines_[i].is_ended; }
  // Whether they are so many as one asked for, and there may be more.
  [[nodiscard]] bool is_full() const { return text_.size() >= kBytes; }
  // Throws what stood in the way of the line behind the last.
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  struct Line {
    std::size_t first;
    std::size_t length;
    bool is_ended;
  };
  void take(std::string_view line, bool is_ended);

  std::string text_;
  std::vector<Line> lines_;
  std::exception_ptr error_;
};

}  // namespace offnominal::desk
