#pragma once

#include <csv.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace offnominal::desk {

// What parts the cells of a line: ',', ';', a tab, or runs of blanks (' ').
[[nodiscard]] char separator_of(std::string_view line);

// Splits one line at a time.
class CsvLineSplitter {
 public:
  explicit CsvLineSplitter(char separator);
  CsvLineSplitter(const CsvLineSplitter&) = delete;
  CsvLineSplitter& operator=(const CsvLineSplitter&) = delete;
  ~CsvLineSplitter();

  // The cells of a line without the blanks around them and without their quotes, valid until the
  // next call; null for a malformed line.
  const std::vector<std::string>* split(std::string_view line);

 private:
  csv_parser parser_{};
  char separator_;
  std::string collapsed_;
  std::vector<std::string> cells_;
  std::size_t count_ = 0;
  bool out_of_memory_ = false;
};

// A number with a decimal point, also with a typeset minus or Fortran's D of an exponent; none for
// any other text.
[[nodiscard]] std::optional<double> number_in(std::string_view text);
// The same with a decimal comma.
[[nodiscard]] std::optional<double> number_with_comma(std::string_view text);
// A number of either kind, a date, a time of day, or both: what stands in a line of samples and in
// no header.
[[nodiscard]] bool is_value(std::string_view text);

}  // namespace offnominal::desk
