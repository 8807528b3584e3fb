#include "log/csv_line.hpp"

#include <algorithm>
#include <charconv>
#include <new>

#include "log/date_time.hpp"
#include "log/split_time.hpp"

namespace offnominal::desk {
namespace {

bool is_gap(char c) { return c == ' ' || c == '\t'; }

// Runs of blanks as one, none at either end; what stands in quotes stays.
void collapse(std::string_view line, std::string& to) {
  to.clear();
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (quoted || !is_gap(c)) {
      to += c;
    } else if (!to.empty() && to.back() != ' ') {
      to += ' ';
    }
  }
  while (!to.empty() && to.back() == ' ') to.pop_back();
}

std::size_t count_outside_quotes(std::string_view line, char wanted) {
  std::size_t count = 0;
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (!quoted && c == wanted) ++count;
  }
  return count;
}

}  // namespace

char separator_of(std::string_view line) {
  // A decimal comma stands in each cell, the separator between two of them.
  char best = ' ';
  std::size_t most = 0;
  for (const char separator : {',', ';', '\t'}) {
    const std::size_t count = count_outside_quotes(line, separator);
    if (count == 0) continue;
    const bool beats_comma = best == ',' && count + 1 >= most;
    if (best == ' ' || beats_comma || (best != ',' && count > most)) {
      best = separator;
      most = count;
    }
  }
  if (best != ',') return best;
  // "0,5 1,25": commas in every cell between blanks.
  CsvLineSplitter blanks(' ');
  const auto* cells = blanks.split(line);
  const bool are_numbers = cells != nullptr && cells->size() > 1 &&
                           std::all_of(cells->begin(), cells->end(), number_with_comma);
  return are_numbers ? ' ' : ',';
}

CsvLineSplitter::CsvLineSplitter(char separator) : separator_(separator) {
  if (csv_init(&parser_, CSV_STRICT | CSV_STRICT_FINI) != 0) throw std::bad_alloc();
  csv_set_delim(&parser_, static_cast<unsigned char>(separator));
}

CsvLineSplitter::~CsvLineSplitter() { csv_free(&parser_); }

const std::vector<std::string>* CsvLineSplitter::split(std::string_view line) {
  if (separator_ == ' ') {
    collapse(line, collapsed_);
    line = collapsed_;
  }
  count_ = 0;
  // Called from C: must not throw, so a failed allocation is carried out by hand.
  const auto on_cell = [](void* text, std::size_t size, void* self) {
    auto& to = *static_cast<CsvLineSplitter*>(self);
    try {
      if (to.count_ == to.cells_.size()) to.cells_.emplace_back();
      to.cells_[to.count_].assign(static_cast<const char*>(text), size);
      ++to.count_;
    } catch (const std::bad_alloc&) {
      to.out_of_memory_ = true;
    }
  };
  const bool parsed =
      csv_parse(&parser_, line.data(), line.size(), on_cell, nullptr, this) == line.size() &&
      csv_fini(&parser_, on_cell, nullptr, this) == 0;
  if (out_of_memory_) throw std::bad_alloc();
  if (!parsed) {
    // What it has begun would be the beginning of the next line.
    csv_free(&parser_);
    if (csv_init(&parser_, CSV_STRICT | CSV_STRICT_FINI) != 0) throw std::bad_alloc();
    csv_set_delim(&parser_, static_cast<unsigned char>(separator_));
    return nullptr;
  }
  cells_.resize(count_);
  return &cells_;
}

namespace {

// As typesetting and Fortran write them: "\u22121.5", "1.5D-03"; none for any other text.
std::optional<std::string> usual_spelling(std::string_view text) {
  constexpr std::string_view kMinus = "\u2212";
  std::string usual(text);
  for (std::size_t at = usual.find(kMinus); at != std::string::npos; at = usual.find(kMinus)) {
    usual.replace(at, kMinus.size(), "-");
  }
  // With a sign and two digits at least: "2D-3" is a name.
  const std::size_t exponent = usual.find('D');
  if (exponent != std::string::npos && usual.size() > exponent + 3 &&
      (usual[exponent + 1] == '+' || usual[exponent + 1] == '-')) {
    usual[exponent] = 'e';
  }
  return usual == text ? std::nullopt : std::optional(usual);
}

}  // namespace

std::optional<double> number_in(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && end == text.data() + text.size()) return value;
  const auto usual = usual_spelling(text);
  return usual ? number_in(*usual) : std::nullopt;
}

std::optional<double> number_with_comma(std::string_view text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos || comma + 1 == text.size() ||
      text.find('.') != std::string_view::npos) {
    return std::nullopt;
  }
  std::string pointed(text);
  pointed[comma] = '.';
  return number_in(pointed);
}

bool is_value(std::string_view text) {
  return number_in(text) || number_with_comma(text) || date_time_ns(text) || is_day(text) ||
         is_clock(text);
}

}  // namespace offnominal::desk
