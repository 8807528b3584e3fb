#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "log/recording_file.hpp"

namespace offnominal::desk {

// How a text file of samples is laid out, as its first lines tell.
struct CsvLayout {
  char separator = ',';            // ' ': runs of blanks
  std::vector<std::string> names;  // of the cells of a line; empty: an index that nobody named
  bool has_names = true;           // else they are the numbers of the columns, from 1
  bool has_trailing = false;       // a separator may stand behind the last cell
  bool has_row_names = false;      // a cell in front of those that the header names
  std::map<std::string, std::string> units;  // a line of them under the header, by name
  std::vector<std::string> remarks;
  std::string first;            // line of samples; empty: there is none
  std::size_t first_line = 0;   // its number, from 1
  std::size_t header_line = 0;  // 0: none
  bool first_ended = true;      // its line end was there
  // Lines behind it that were read to find the header, and whether they were ended.
  std::vector<std::pair<std::string, bool>> ahead;

  [[nodiscard]] std::size_t cells() const { return names.size(); }
};

// A line that says nothing of a sample: behind '#' or '%'.
[[nodiscard]] bool is_comment(std::string_view line);
[[nodiscard]] bool is_blank_line(std::string_view line);

// Reads up to the first line of samples. Lines before a header that fits the numbers below it,
// where the first line is none, are left out with a remark. Throws InputError, with the line, where
// a header has a number, the same name twice, or a name missing that is not the first or the last.
[[nodiscard]] CsvLayout read_csv_layout(RecordingFile& file);

}  // namespace offnominal::desk
