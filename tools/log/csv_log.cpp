#include "log/csv_log.hpp"

#include <csv.h>

#include <algorithm>
#include <charconv>
#include <deque>
#include <new>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/error.hpp"

namespace offnominal::tools {
namespace {

// Splits one line at a time.
class LineSplitter {
 public:
  explicit LineSplitter(char separator) {
    if (csv_init(&parser_, CSV_STRICT | CSV_STRICT_FINI) != 0) throw std::bad_alloc();
    csv_set_delim(&parser_, static_cast<unsigned char>(separator));
  }
  LineSplitter(const LineSplitter&) = delete;
  LineSplitter& operator=(const LineSplitter&) = delete;
  ~LineSplitter() { csv_free(&parser_); }

  // The cells of a line, valid until the next call; null for a malformed line.
  const std::vector<std::string>* split(const std::string& line) {
    count_ = 0;
    // Called from C: must not throw, so a failed allocation is carried out by hand.
    const auto on_cell = [](void* text, std::size_t size, void* self) {
      auto& to = *static_cast<LineSplitter*>(self);
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
    if (!parsed) return nullptr;
    cells_.resize(count_);
    return &cells_;
  }

 private:
  csv_parser parser_{};
  std::vector<std::string> cells_;
  std::size_t count_ = 0;
  bool out_of_memory_ = false;
};

std::optional<double> number_in(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// Whether it is none yet, and with more digits would be a number: "-", "1.2e-".
bool is_begun(std::string_view text) {
  return !number_in(text) && number_in(std::string(text) + "0");
}

char separator_of(const std::string& header) {
  for (const char separator : {',', ';', '\t'}) {
    if (header.find(separator) != std::string::npos) return separator;
  }
  return ',';
}

bool blank(const std::string& line) { return line.find_first_not_of(" \t") == std::string::npos; }

class CsvReader {
 public:
  CsvReader(RecordingFile& file, const NeedOf& need_of) : file_(file), need_of_(need_of) {}

  NamedColumns read() {
    std::string line;
    if (!next(line)) fail("", "an empty file", "a header line and one line per sample");
    if (line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    separator_ = separator_of(line);
    read_header(line);
    LineSplitter splitter(separator_);
    while (kept_ > 0 && ascending_ && next(line)) read_row(splitter, line);
    if (kept_ > 0 && rows_ == 0)
      fail("line 1", "a header without samples", "one line of numbers per sample");
    return result();
  }

 private:
  struct Column {
    Need need = Need::kNone;
    std::deque<double> values;  // takes no more memory than it holds
  };

  [[noreturn]] void fail(const std::string& place, const std::string& found,
                         const std::string& allowed, const std::string& mend = {}) const {
    throw InputError({file_.name(), place, found, allowed, mend});
  }

  std::string line_place() const { return "line " + std::to_string(line_number_); }

  bool next(std::string& line) {
    if (!file_.next_line(line)) return false;
    ++line_number_;
    unfinished_ = !file_.line_ended();
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return true;
  }

  void read_header(const std::string& line) {
    LineSplitter splitter(separator_);
    std::set<std::string> seen;
    const auto* cells = splitter.split(line);
    if (cells == nullptr) fail("line 1", "an unfinished quote", "names, with both quotes or none");
    for (const std::string& name : *cells) {
      const std::string place = "line 1, column " + std::to_string(names_.size() + 1);
      if (name.empty()) fail(place, "no name", "a name per column");
      if (number_in(name)) {
        fail(place, "the number " + name, "a header line that names the columns",
             "put the columns' names in the first line");
      }
      if (!seen.insert(name).second) fail("line 1", "column \"" + name + "\" twice", "one of each");
      names_.push_back(name);
      columns_.push_back({need_of_(name), {}});
      if (columns_.back().need != Need::kNone) ++kept_;
    }
    if (names_.empty()) fail("line 1", "a blank line", "a header line that names the columns");
  }

  void read_row(LineSplitter& splitter, const std::string& line) {
    if (blank(line)) {
      blank_line_ = blank_line_ == 0 ? line_number_ : blank_line_;
      return;
    }
    if (blank_line_ != 0) {
      fail("line " + std::to_string(blank_line_), "a blank line", "samples without gaps");
    }
    const auto* cells = splitter.split(line);
    // As a writer that was killed leaves it; of a number that ends early nobody can tell.
    const bool is_short = cells == nullptr || cells->size() < columns_.size() ||
                          cells->back().empty() || is_begun(cells->back());
    if (unfinished_ && is_short && rows_ > 0) {
      cut_off_ = true;
      return;
    }
    if (cells == nullptr) fail(line_place(), "an unfinished quote", "numbers");
    if (cells->size() != columns_.size()) {
      fail(line_place(),
           std::to_string(cells->size()) + (cells->size() == 1 ? " value" : " values"),
           std::to_string(columns_.size()) + ", as many as the header has names");
    }
    for (std::size_t i = 0; i < columns_.size(); ++i) read_cell(columns_[i], i, (*cells)[i]);
    ++rows_;
    if (rows_ <= RecordingFile::kMostNumbers / std::max<std::size_t>(1, kept_)) return;
    fail(line_place(), "more than " + std::to_string(RecordingFile::kMostNumbers) + " numbers",
         "a recording that ends", "cut it into parts, or leave samples or columns out");
  }

  void read_cell(Column& column, std::size_t index, std::string_view text) {
    if (column.need == Need::kNone) return;
    const std::optional<double> value = number_in(text);
    if (value) {
      if (column.need == Need::kAscending && !column.values.empty()) {
        ascending_ = *value > column.values.back();
      }
      column.values.push_back(*value);
    } else if (column.need == Need::kWelcome) {
      column.need = Need::kNone;
      column.values = {};
      --kept_;
    } else {
      const std::string found =
          text.empty() ? "nothing" : "\"" + std::string(text.substr(0, 40)) + "\"";
      fail(line_place() + ", column " + names_[index], found, "a number with a decimal point");
    }
  }

  NamedColumns result() {
    NamedColumns result;
    result.file = file_.name();
    result.names = names_;
    if (cut_off_) {
      result.remarks.push_back("The file's last line is cut off and was left out.");
    }
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (columns_[i].need == Need::kNone) continue;
      std::deque<double> values = std::exchange(columns_[i].values, {});
      Eigen::VectorXd& column = result.columns[names_[i]];
      column.resize(static_cast<Eigen::Index>(values.size()));
      std::copy(values.begin(), values.end(), column.begin());
    }
    result.place_of = [](Eigen::Index row) { return "line " + std::to_string(row + 2); };
    return result;
  }

  RecordingFile& file_;
  const NeedOf& need_of_;
  char separator_ = ',';
  std::size_t line_number_ = 0;
  std::size_t blank_line_ = 0;
  std::size_t rows_ = 0;
  std::size_t kept_ = 0;     // columns
  bool ascending_ = true;    // time, so far
  bool unfinished_ = false;  // no line end after the newest line
  bool cut_off_ = false;     // the last line was left out
  std::vector<std::string> names_;
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

}  // namespace offnominal::tools
