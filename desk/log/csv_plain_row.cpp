#include "log/csv_plain_row.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <system_error>

namespace offnominal::desk {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t'; }

// Where the number at `at` ends; null where there is none of the column's form.
const char* number_at(const CsvColumn& column, const char* at, const char* end, double& value) {
  if (column.form == CsvColumn::Form::kDate) return nullptr;
  if (at != end && *at == '+') ++at;
  if (column.form == CsvColumn::Form::kLongNumber) {
    std::int64_t whole = 0;
    const auto [stop, error] = std::from_chars(at, end, whole);
    if (error != std::errc() || (stop != end && (*stop == '.' || *stop == 'e' || *stop == 'E'))) {
      return nullptr;
    }
    value = difference(whole, column.origin);
    return stop;
  }
  const auto [stop, error] = std::from_chars(at, end, value);
  return error == std::errc() ? stop : nullptr;
}

// Where a cell that nobody needs ends; null for one in quotes.
const char* end_of_cell(const char* at, const char* end, char separator) {
  while (at != end && *at != separator && *at != '"' && !(separator == ' ' && *at == '\t')) ++at;
  return at != end && *at == '"' ? nullptr : at;
}

}  // namespace

double difference(std::int64_t a, std::int64_t b) {
  if ((a < 0) == (b < 0)) return static_cast<double>(a - b);
  return static_cast<double>(a) - static_cast<double>(b);
}

PlainRow read_plain_row(const PlainRows& rows, std::string_view line, Eigen::Index row,
                        std::vector<CsvColumn>& columns, std::string& scratch) {
  if (is_comment(line)) return {};
  const std::string_view written = line;
  if (rows.has_commas) {
    scratch = line;
    std::replace(scratch.begin(), scratch.end(), ',', '.');
    line = scratch;
  }
  const char separator = rows.layout.separator;
  const bool has_marks = separator != ',';
  const auto is_gap = [separator](char c) { return is_blank(c) && c != separator; };
  const char* at = line.data();
  const char* const end = at + line.size();
  double time = 0;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    CsvColumn& column = columns[i];
    while (at != end && (separator == ' ' ? is_blank(*at) : is_gap(*at))) ++at;
    if (column.need == Need::kNone) {
      at = end_of_cell(at, end, separator);
      if (at == nullptr) return {};
    } else {
      double value = 0;
      const char* const stop = number_at(column, at, end, value);
      if (stop == nullptr || (stop != end && *stop == '.')) return {};
      const std::string_view cell = written.substr(static_cast<std::size_t>(at - line.data()),
                                                   static_cast<std::size_t>(stop - at));
      if (has_marks && is_required(column.need) && rows.marks.is_news(cell)) return {};
      at = stop;
      if (column.need == Need::kAscending) time = value;
      column.values[row] = value;
    }
    if (separator == ' ') {
      if (at != end && !is_blank(*at)) return {};
      continue;
    }
    while (at != end && is_gap(*at)) ++at;
    const bool last = i + 1 == columns.size();
    if (last && at != end && *at == separator && rows.layout.has_trailing) ++at;
    if (last) break;
    if (at == end || *at != separator) return {};
    ++at;
  }
  while (at != end && is_blank(*at)) ++at;
  return {at == end, time};
}

}  // namespace offnominal::desk
