#include "log/csv_log.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "common/encoding.hpp"
#include "common/error.hpp"
#include "common/parallel.hpp"
#include "common/small_letters.hpp"
#include "log/csv_column.hpp"
#include "log/csv_layout.hpp"
#include "log/csv_line.hpp"
#include "log/csv_lines.hpp"
#include "log/csv_plain_row.hpp"
#include "log/date_time.hpp"
#include "log/decimal_marks.hpp"
#include "log/split_time.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;

// Whether it is none yet, and with more digits would be a number: "-", "1.2e-".
bool is_begun(std::string_view text) {
  return !number_in(text) && number_in(std::string(text) + "0");
}

// What stands for a number that there is none of.
bool is_none(std::string_view text) {
  constexpr std::array<std::string_view, 6> kNone{"", "NA", "N/A", "null", "None", "<NA>"};
  return std::find(kNone.begin(), kNone.end(), text) != kNone.end();
}

// "10:00:00.5", "11/24/2026", "24.11.26", and no number with a letter too many.
bool has_marks_of_a_clock(std::string_view text) {
  const auto twice = [](std::string_view in, char mark) {
    return std::count(in.begin(), in.end(), mark) > 1;
  };
  return text.find_first_of(":/") != std::string_view::npos || twice(text, '.') || twice(text, '-');
}

constexpr const char* kTimes =
    "time in s, or a date with its time, in one column or two: 2026-11-24T02:14:30.123 or "
    "24.11.2026 02:14:30.123";

bool has_small_letter(const std::string& text) {
  return std::any_of(text.begin(), text.end(), [](char c) { return c >= 'a' && c <= 'z'; });
}

// Up to this every whole number is a double.
constexpr double kLargestWhole = 9007199254740992.0;

std::optional<std::int64_t> whole_in(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

class CsvReader {
 public:
  CsvReader(RecordingFile& file, const NeedOf& need_of, const MeaningOf& meaning_of = {})
      : file_(file), need_of_(need_of), meaning_of_(meaning_of) {}

  NamedColumns read() {
    layout_ = read_csv_layout(file_);
    name_columns();
    if (!layout_.first.empty() && kept_ > 0) read_samples();
    if (kept_ > 0 && rows_ == 0) {
      fail("line " + std::to_string(layout_.header_line), "a header without samples",
           "one line of numbers per sample");
    }
    return result();
  }

 private:
  using Column = CsvColumn;
  using Form = CsvColumn::Form;

  [[noreturn]] void fail(const std::string& place, const std::string& found,
                         const std::string& allowed, const std::string& mend = {}) const {
    throw InputError({file_.name(), place, found, allowed, mend});
  }

  std::string line_place() const { return "line " + std::to_string(line_number_); }

  // By its name or, where nobody asks for that, by its number, or by its name in small letters
  // where the header has none.
  void name_columns() {
    const auto& names = layout_.names;
    const bool capitals =
        layout_.has_names && std::none_of(names.begin(), names.end(), has_small_letter);
    bool renamed = false;
    for (std::size_t i = 0; i < names.size(); ++i) {
      Column column;
      column.name = names[i];
      column.need = column.name.empty() ? Need::kNone : need_of_(column.name);
      const auto also = [&](std::string name, bool& taken) {
        const Need need = need_of_(name);
        taken = !is_required(column.need) && is_required(need);
        if (!taken) return;
        column.name = std::move(name);
        column.need = need;
      };
      bool by_number = false;
      also(std::to_string(i + 1), by_number);
      bool by_small = false;
      if (capitals && !column.name.empty()) also(in_small_letters(names[i]), by_small);
      renamed = renamed || by_small;
      if (column.need != Need::kNone) ++kept_;
      columns_.push_back(std::move(column));
    }
    // Beside the time no other one is looked for.
    const bool has_time = std::any_of(columns_.begin(), columns_.end(), [](const Column& column) {
      return column.need == Need::kAscending;
    });
    for (Column& column : columns_) {
      if (has_time && column.need == Need::kTime) column.need = Need::kWelcome;
    }
    if (renamed) remarks_.emplace_back("the file's names are in capitals: T is read as t");
  }

  void read_samples() {
    CsvLineSplitter splitter(layout_.separator);
    line_number_ = layout_.first_line;
    unfinished_ = !layout_.first_ended;
    // Before anything is known of its cells.
    read_row_slowly(splitter, layout_.first);
    CsvLines lines = CsvLines::next(file_, layout_);
    while (goes_on()) {
      make_room(lines.size());
      CsvLines ahead;
      std::vector<PlainRow> plain;
      if (lines.is_full()) {
        const std::jthread reader([&] { ahead = CsvLines::next(file_, layout_); });
        plain = plain_rows(lines);
      }
      take(lines, plain, splitter);
      if (!goes_on()) return;
      lines.rethrow();
      if (!lines.is_full()) return;
      lines = std::move(ahead);
    }
  }

  [[nodiscard]] bool goes_on() const { return kept_ > 0 && ascending_; }

  // Each as if all lines before it were plain ones.
  std::vector<PlainRow> plain_rows(const CsvLines& lines) {
    constexpr std::size_t kParts = 4;  // per thread
    std::vector<PlainRow> rows(lines.size());
    const int threads = all_threads();
    const std::size_t parts = kParts * static_cast<std::size_t>(threads);
    parallel_for(parts, threads, [&](std::size_t part) {
      std::string scratch;
      const std::size_t end = (part + 1) * lines.size() / parts;
      for (std::size_t i = part * lines.size() / parts; i < end; ++i) {
        rows[i] = plain_row(lines.line(i), static_cast<Index>(rows_ + i), scratch);
      }
    });
    return rows;
  }

  PlainRow plain_row(std::string_view line, Index row, std::string& scratch) {
    return read_plain_row({layout_, marks_, has_commas_}, line, row, columns_, scratch);
  }

  // `plain`: of these lines, or nothing.
  void take(const CsvLines& lines, const std::vector<PlainRow>& plain, CsvLineSplitter& splitter) {
    const std::size_t first = rows_;
    for (std::size_t i = 0; i < lines.size() && goes_on(); ++i) {
      ++line_number_;
      unfinished_ = !lines.is_ended(i);
      const bool is_in_place = !plain.empty() && rows_ == first + i;
      PlainRow row = is_in_place ? plain[i] : PlainRow{};
      if (!row.is_plain) row = plain_row(lines.line(i), static_cast<Index>(rows_), scratch_);
      if (!unfinished_ && row.is_plain) {
        take_time(row.time);
        end_row();
      } else {
        read_row_slowly(splitter, lines.line(i));
      }
      if (rows_ > most_rows()) {
        fail(line_place(), "more than " + std::to_string(RecordingFile::kMostNumbers) + " numbers",
             "a recording that ends", "cut it into parts, or leave samples or columns out");
      }
    }
  }

  std::size_t most_rows() const {
    return RecordingFile::kMostNumbers / std::max<std::size_t>(1, kept_);
  }

  void make_room(std::size_t rows = 1) {
    if (rows_ + rows <= room_) return;
    constexpr std::size_t kFirstRoom = 256;
    room_ = std::max({kFirstRoom, 2 * room_, rows_ + rows});
    for (Column& column : columns_) {
      if (column.need != Need::kNone) column.values.conservativeResize(static_cast<Index>(room_));
    }
  }

  // Of what somebody asked for.
  void note_marks(const Column& column, std::string_view text) {
    if (layout_.separator == ',' || !is_required(column.need)) return;
    const auto found = marks_.note(text, column.name);
    if (!found) return;
    fail(line_place(),
         "numbers with a decimal comma and others with a point, one of which may stand between "
         "thousands: " +
             found->thousands + " and " + found->decimals,
         "one decimal mark in all that is read",
         "write the recording with one mark and without marks between thousands, or leave such "
         "columns out of [channels]");
  }

  // As far as time ascends: single rows that do not are left out later.
  void take_time(double time) {
    constexpr std::size_t kFewOutOfTime = 10;
    if (has_time_ && !(time > last_time_)) {
      ++out_of_time_;
      // More than a tenth, which time_of() refuses, of the rows with this one.
      ascending_ = out_of_time_ <= kFewOutOfTime || kFewOutOfTime * out_of_time_ <= rows_ + 1;
      return;
    }
    last_time_ = time;
  }

  void end_row() {
    ++rows_;
    last_line_ = line_number_;
  }

  void read_row_slowly(CsvLineSplitter& splitter, std::string_view line) {
    make_room();
    if (is_blank_line(line)) {
      skipped_.push_back(line_number_);
      blank_lines_.push_back(line_number_);
      return;
    }
    if (is_comment(line)) {
      skipped_.push_back(line_number_);
      return;
    }
    std::string of_windows;
    if (utf8_bytes(line) < line.size()) line = of_windows = from_windows_1252(line);
    const auto* cells = splitter.split(line);
    // As a writer that was killed leaves it; of a number that ends early nobody can tell.
    const bool is_short = cells == nullptr || cells->size() < columns_.size() ||
                          cells->back().empty() || is_begun(cells->back());
    if (unfinished_ && is_short && rows_ > 0) {
      cut_off_ = true;
      return;
    }
    if (cells == nullptr) fail(line_place(), "an unfinished quote", "numbers");
    const bool trailing =
        layout_.has_trailing && cells->size() == columns_.size() + 1 && cells->back().empty();
    if (cells->size() != columns_.size() && !trailing) {
      fail(line_place(),
           std::to_string(cells->size()) + (cells->size() == 1 ? " value" : " values"),
           std::to_string(columns_.size()) + ", as many as the " +
               (layout_.has_names ? "header has names" : "first line has"));
    }
    double time = last_time_;
    for (std::size_t i = 0; i < columns_.size(); ++i) read_cell(i, *cells, time);
    take_time(time);
    end_row();
  }

  void read_cell(std::size_t index, const std::vector<std::string>& cells, double& time) {
    Column& column = columns_[index];
    if (column.need == Need::kNone) return;
    const bool is_time = column.need == Need::kAscending || column.need == Need::kTime;
    std::string_view text = cells[index];
    if (is_time && rows_ == 0) column.other_half = other_half_of(cells, index);
    std::string of_both;
    if (column.other_half) text = of_both = whole_time(text, cells[*column.other_half]);
    if (is_time && rows_ == 0) begin_time(column, text);
    std::optional<double> value =
        is_time && column.form != Form::kNumber ? time_in(column, text) : number_in(text);
    if (!value && layout_.separator != ',') {
      value = number_with_comma(text);
      has_commas_ = has_commas_ || value;
    }
    if (value && column.form == Form::kNumber) note_marks(column, text);
    if (!value && meaning_of_) {
      value = meaning_of_(line_place() + ", column " + column.name, column.name, std::string(text));
    }
    if (!value && column.need != Need::kWelcome && column.form == Form::kNumber && is_none(text)) {
      value = std::numeric_limits<double>::quiet_NaN();
    }
    if (value) {
      if (column.need == Need::kAscending) time = *value;
      column.values[static_cast<Index>(rows_)] = *value;
    } else if (!is_required(column.need)) {
      if (is_time && has_marks_of_a_clock(text)) {
        remarks_.push_back(line_place() + ", column " + column.name + ": \"" +
                           std::string(text.substr(0, 40)) + "\" is no " + kTimes);
      }
      column.need = Need::kNone;
      column.values.resize(0);
      --kept_;
    } else {
      const std::string found =
          text.empty() ? "nothing" : "\"" + std::string(text.substr(0, 40)) + "\"";
      const std::string place = line_place() + ", column " + column.name;
      if (is_time && column.form == Form::kDate) {
        fail(place, found, "a date as in the lines before, 2026-11-24T02:14:30.123");
      }
      if (is_time && has_marks_of_a_clock(text)) {
        fail(place, found, std::string("a ") + kTimes,
             "write the times so, or say the step between two samples: --period");
      }
      fail(place, found, "a number with a decimal point");
    }
  }

  // What the first cell shows of a column of time.
  void begin_time(Column& column, std::string_view text) {
    has_time_ = has_time_ || column.need == Need::kAscending;
    const auto whole = whole_in(text);
    if (whole && std::abs(static_cast<double>(*whole)) >= kLargestWhole) {
      column.form = Form::kLongNumber;
      column.origin = *whole;
    } else if (const auto date = date_time_ns(text)) {
      column.form = Form::kDate;
      column.origin = *date;
      remarks_.push_back("the time of " + column.name + " is a date: t = 0 s is " +
                         std::string(text));
    }
  }

  static std::optional<double> time_in(const Column& column, std::string_view text) {
    constexpr double kSecond = 1e9;
    const auto cell = column.form == Form::kDate ? date_time_ns(text) : whole_in(text);
    if (!cell) return std::nullopt;
    const double passed = difference(*cell, column.origin);
    return column.form == Form::kDate ? passed / kSecond : passed;
  }

  NamedColumns result() {
    NamedColumns result;
    result.file = file_.name();
    result.has_names = layout_.has_names;
    result.remarks = layout_.remarks;
    result.remarks.insert(result.remarks.end(), remarks_.begin(), remarks_.end());
    if (cut_off_) {
      result.remarks.push_back("The file's last line is cut off and was left out.");
    }
    if (!ascending_) {
      result.remarks.push_back("read as far as line " + std::to_string(last_line_) + ": in " +
                               std::to_string(out_of_time_) +
                               " lines the time is not later than before");
    }
    const auto blank = std::count_if(blank_lines_.begin(), blank_lines_.end(),
                                     [this](std::size_t line) { return line < last_line_; });
    if (blank > 0) {
      result.remarks.push_back(
          (blank == 1 ? "1 blank line" : std::to_string(blank) + " blank lines") +
          " between the samples left out: line " + std::to_string(blank_lines_.front()) + " first");
    }
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      Column& column = columns_[i];
      if (!column.name.empty()) result.names.push_back(column.name);
      if (const auto unit = layout_.units.find(layout_.names[i]); unit != layout_.units.end()) {
        result.units[column.name] = unit->second;
      }
      if (column.need == Need::kNone) continue;
      column.values.conservativeResize(static_cast<Index>(rows_));
      result.columns[column.name] = std::move(column.values);
      if (column.form == Form::kNumber) continue;
      const bool is_date = column.form == Form::kDate;
      const double value = static_cast<double>(column.origin) * (is_date ? 1e-9 : 1);
      result.origins[column.name] = {value, is_date};
    }
    result.place_of = [first = layout_.first_line, skipped = skipped_](Index row) {
      std::size_t line = first + static_cast<std::size_t>(row);
      for (const std::size_t other : skipped) line += other <= line ? 1 : 0;
      return "line " + std::to_string(line);
    };
    return result;
  }

  RecordingFile& file_;
  const NeedOf& need_of_;
  MeaningOf meaning_of_;
  CsvLayout layout_;
  std::size_t line_number_ = 0;
  std::size_t last_line_ = 0;  // that holds a row
  std::vector<std::size_t> blank_lines_;
  std::size_t rows_ = 0;
  std::size_t room_ = 0;              // rows that the columns have room for
  std::size_t kept_ = 0;              // columns
  std::vector<std::size_t> skipped_;  // comments and blank lines between the samples
  bool has_time_ = false;
  bool ascending_ = true;                                        // time, so far
  double last_time_ = -std::numeric_limits<double>::infinity();  // that ascends
  std::size_t out_of_time_ = 0;                                  // rows
  bool has_commas_ = false;                                      // as decimal marks
  DecimalMarks marks_;
  std::string scratch_;
  bool unfinished_ = false;  // no line end after the newest line
  bool cut_off_ = false;     // the last line was left out
  std::vector<std::string> remarks_;
  std::vector<Column> columns_;
};

}  // namespace

NamedColumns read_csv(RecordingFile& file, const ChannelMap* /*channels*/, const NeedOf& need_of) {
  return CsvReader(file, need_of).read();
}

NamedColumns read_csv(const std::filesystem::path& path, const NeedOf& need_of) {
  RecordingFile file(path);
  return read_csv(file, nullptr, need_of);
}

NamedColumns read_csv(const std::filesystem::path& path, const NeedOf& need_of,
                      const MeaningOf& meaning_of) {
  RecordingFile file(path);
  return CsvReader(file, need_of, meaning_of).read();
}

}  // namespace offnominal::desk
