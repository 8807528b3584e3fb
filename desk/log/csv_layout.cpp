#include "log/csv_layout.hpp"

#include <algorithm>
#include <deque>
#include <functional>
#include <set>
#include <string_view>
#include <utility>

#include "common/encoding.hpp"
#include "common/error.hpp"
#include "log/csv_line.hpp"
#include "log/split_time.hpp"

namespace offnominal::desk {
namespace {

using Cells = std::vector<std::string>;

std::string_view without_line_end(std::string_view line) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

// "[rad/s]" and "(s)" as they are meant.
std::string unit_in(std::string text) {
  const bool in_brackets = text.size() > 2 && ((text.front() == '[' && text.back() == ']') ||
                                               (text.front() == '(' && text.back() == ')'));
  return in_brackets ? text.substr(1, text.size() - 2) : text;
}

bool any_text(const Cells& cells) {
  return std::any_of(cells.begin(), cells.end(), [](const auto& cell) { return !cell.empty(); });
}

bool all_values(const Cells& cells) {
  return any_text(cells) && std::all_of(cells.begin(), cells.end(), [](const std::string& cell) {
           return cell.empty() || is_value(cell);
         });
}

bool any_value(const Cells& cells) {
  return std::any_of(cells.begin(), cells.end(), [](const auto& cell) { return is_value(cell); });
}

bool no_values(const Cells& cells) { return any_text(cells) && !any_value(cells); }

// 0, 1, 2 ... as pandas writes for columns without names, behind the empty one of its index.
bool is_count_from_zero(const Cells& cells) {
  const std::size_t first = !cells.empty() && cells[0].empty() ? 1 : 0;
  if (first == 0 || cells.size() < 3) return false;
  for (std::size_t i = first; i < cells.size(); ++i) {
    if (cells[i] != std::to_string(i - first)) return false;
  }
  return true;
}

class LayoutReader {
 public:
  explicit LayoutReader(RecordingFile& file) : file_(file) {}

  CsvLayout read() {
    std::string line;
    if (!next_content(line)) {
      fail("", "an empty file", "a header line and one line per sample",
           "check the name, and whether the recording was saved");
    }
    take_separator_line(line);
    if (layout_.separator == 0) leave_out_preamble(line);
    if (layout_.separator == 0) layout_.separator = separator_of(line);
    CsvLineSplitter splitter(layout_.separator);
    const Cells* const split = splitter.split(line);
    if (split == nullptr) fail(place(), "an unfinished quote", "names, with both quotes or none");
    const Cells cells = *split;
    if (is_count_from_zero(cells)) {
      name_by_number(cells.size());
      layout_.remarks.push_back(
          "the file numbers its columns from 0; here they count from 1, the unnamed one with them");
      layout_.header_line = line_;
      read_first(splitter);
    } else if (all_values(cells)) {
      take_first(line);
      if (!name_by_comment(cells)) name_by_number(cells.size() - (layout_.has_trailing ? 1 : 0));
    } else if (any_value(cells) && name_by_comment(cells)) {
      take_first(line);
    } else if (is_sample(cells)) {
      take_first(line);
      name_by_number(cells.size() - (layout_.has_trailing ? 1 : 0));
    } else {
      layout_.header_line = line_;
      name_by(cells);
      read_first(splitter);
    }
    for (Line& ahead : ahead_) layout_.ahead.emplace_back(std::move(ahead.text), ahead.ended);
    return std::move(layout_);
  }

 private:
  struct Line {
    std::string text;
    bool ended = true;
  };

  [[noreturn]] void fail(const std::string& place, const std::string& found,
                         const std::string& allowed, const std::string& mend = {}) const {
    throw InputError({file_.name(), place, found, allowed, mend});
  }
  std::string place() const { return "line " + std::to_string(line_); }

  bool next_line() {
    if (!ahead_.empty()) {
      newest_ = std::move(ahead_.front());
      ahead_.pop_front();
      return true;
    }
    return read_line(newest_);
  }

  bool read_line(Line& line) {
    if (!file_.next_line(line.text)) return false;
    line.ended = file_.line_ended();
    ++lines_read_;
    if (utf8_bytes(line.text) == line.text.size()) return true;
    line.text = from_windows_1252(line.text);
    if (!is_told_as_windows_) {
      layout_.remarks.push_back("line " + std::to_string(lines_read_) +
                                " is no UTF-8: read as Windows-1252 (Latin-1); where that is "
                                "wrong, save the file in UTF-8");
    }
    is_told_as_windows_ = true;
    return true;
  }

  // The line that comes after `index` others, null where there is none; nothing is taken by it.
  const std::string* line_ahead(std::size_t index) {
    while (ahead_.size() <= index) {
      Line line;
      if (!read_line(line)) return nullptr;
      ahead_.push_back(std::move(line));
    }
    return &ahead_[index].text;
  }

  static bool says_nothing(std::string_view line) {
    return is_blank_line(line) || is_comment(line);
  }

  // The cells of the first line that says something from `index` of those ahead on, empty where
  // there is none; `index` is behind it then.
  Cells cells_ahead(std::size_t& index, char separator) {
    CsvLineSplitter splitter(separator);
    for (const std::string* line = line_ahead(index); line != nullptr; line = line_ahead(index)) {
      ++index;
      const std::string_view view = without_line_end(*line);
      if (says_nothing(view)) continue;
      const Cells* const cells = splitter.split(view);
      return cells == nullptr ? Cells() : *cells;
    }
    return {};
  }

  // Whether a line names the columns of the numbers that follow, from `index` of those ahead on.
  bool is_header(std::string_view line, std::size_t index) {
    const char separator = separator_of(line);
    CsvLineSplitter splitter(separator);
    const Cells* const split = splitter.split(line);
    if (split == nullptr || split->size() < 2 || !no_values(*split)) return false;
    const std::size_t count = split->size();
    const std::set<std::string> once(split->begin(), split->end());
    if (once.size() != count) return false;
    Cells below = cells_ahead(index, separator);
    if (below.size() == count && no_values(below)) below = cells_ahead(index, separator);
    return all_values(below) && (below.size() == count || below.size() == count + 1);
  }

  // What somebody wrote above the header: a title, the date, settings. A row of numbers is none.
  void leave_out_preamble(std::string& line) {
    constexpr std::size_t kLongest = 100;  // lines
    if (is_header(line, 0) || has_numbers(line)) return;
    const std::size_t first = line_;
    for (std::size_t i = 0; i < kLongest; ++i) {
      const std::string* const ahead = line_ahead(i);
      if (ahead == nullptr) return;
      const std::string candidate(without_line_end(*ahead));
      if (says_nothing(candidate)) continue;
      if (has_numbers(candidate)) return;
      if (!is_header(candidate, i + 1)) continue;
      for (std::size_t left_out = 0; left_out < i; ++left_out) static_cast<void>(next_line());
      line_ += i;
      static_cast<void>(next_content(line));
      layout_.remarks.push_back(
          line_ == first + 1
              ? "line " + std::to_string(first) + " stands before the header: left out"
              : "lines " + std::to_string(first) + " to " + std::to_string(line_ - 1) +
                    " stand before the header: left out");
      return;
    }
  }

  // As a sample has them, its state in words beside it. A title may have a date and a time of day.
  static bool has_numbers(std::string_view line) {
    CsvLineSplitter splitter(separator_of(line));
    const Cells* const cells = splitter.split(line);
    const auto is_number = [](const std::string& cell) {
      return is_value(cell) && !is_day(cell) && !is_clock(cell);
    };
    return cells != nullptr && std::count_if(cells->begin(), cells->end(), is_number) > 1;
  }

  // Words beside numbers, as a frame beside a stamp, where the next line has either in the same
  // cells. Numbers that count are names.
  bool is_sample(const Cells& cells) {
    std::vector<double> numbers;
    bool are_counted = true;
    for (const std::string& cell : cells) {
      const auto number = number_in(cell);
      if (!number) continue;
      are_counted = are_counted && cell.find_first_not_of("0123456789") == std::string::npos;
      numbers.push_back(*number);
    }
    const auto counts_on = [](double a, double b) { return b == a + 1; };
    const bool are_names =
        are_counted &&
        std::adjacent_find(numbers.begin(), numbers.end(), std::not_fn(counts_on)) == numbers.end();
    if (numbers.size() < 2 || are_names) return false;
    std::size_t index = 0;
    const Cells below = cells_ahead(index, layout_.separator);
    return std::equal(cells.begin(), cells.end(), below.begin(), below.end(),
                      [](const std::string& a, const std::string& b) {
                        return is_value(a) == is_value(b) && a.empty() == b.empty();
                      });
  }

  // The next line that is neither blank nor a comment.
  bool next_content(std::string& line) {
    while (next_line()) {
      ++line_;
      std::string_view view = without_line_end(newest_.text);
      if (line_ == 1 && view.starts_with("\xEF\xBB\xBF")) view.remove_prefix(3);
      if (is_blank_line(view)) continue;
      if (is_comment(view)) {
        comment_ = view.substr(view.find_first_of("#%") + 1);
        comment_line_ = line_;
        continue;
      }
      line = view;
      return true;
    }
    return false;
  }

  // "sep=;", which tells a spreadsheet.
  void take_separator_line(std::string& line) {
    layout_.separator = 0;
    if (line.size() != 5 || !line.starts_with("sep=")) return;
    layout_.separator = line.back();
    if (!next_content(line)) fail(place(), "a separator and nothing else", "a header line");
  }

  void take_first(const std::string& line) {
    layout_.first = line;
    layout_.first_line = line_;
    layout_.first_ended = newest_.ended;
  }

  void read_first(CsvLineSplitter& splitter) {
    std::string line;
    if (!next_content(line)) return;
    const Cells* cells = splitter.split(line);
    if (cells != nullptr && no_values(*cells) && cells->size() == layout_.cells() &&
        layout_.units.empty() && layout_.has_names) {
      for (std::size_t i = 0; i < cells->size(); ++i) {
        if (!(*cells)[i].empty()) layout_.units[layout_.names[i]] = unit_in((*cells)[i]);
      }
      if (!next_content(line)) return;
      cells = splitter.split(line);
    }
    take_first(line);
    if (cells == nullptr || cells->size() != layout_.cells() + 1) return;
    if (cells->back().empty()) {
      layout_.has_trailing = true;
    } else if (line.front() == '"') {
      // As R writes them: a name for each row, and none for their column.
      layout_.has_row_names = true;
      layout_.names.insert(layout_.names.begin(), "");
    }
  }

  void name_by_number(std::size_t count) {
    layout_.has_names = false;
    for (std::size_t i = 1; i <= count; ++i) layout_.names.push_back(std::to_string(i));
  }

  // A comment right before the samples may name them, as numpy and rostopic write it.
  bool name_by_comment(const Cells& first) {
    const std::size_t count = first.size() - (first.size() > 1 && first.back().empty() ? 1 : 0);
    layout_.has_trailing = count < first.size();
    if (comment_.empty() || comment_line_ + 1 != line_) return false;
    for (const char separator : {layout_.separator, separator_of(comment_)}) {
      CsvLineSplitter other(separator);
      const Cells* cells = other.split(comment_);
      if (cells == nullptr || cells->size() != count || !no_values(*cells)) continue;
      const std::set<std::string> once(cells->begin(), cells->end());
      if (once.size() != count || once.contains("")) continue;
      layout_.names = *cells;
      layout_.header_line = comment_line_;
      return true;
    }
    return false;
  }

  void name_by(const Cells& cells) {
    std::set<std::string> seen;
    std::size_t count = cells.size();
    if (count > 1 && cells.back().empty()) {
      layout_.has_trailing = true;
      --count;
    }
    for (std::size_t i = 0; i < count; ++i) {
      const std::string& name = cells[i];
      const std::string at = place() + ", column " + std::to_string(i + 1);
      if (name.empty() && i > 0) fail(at, "no name", "a name per column");
      if (is_value(name)) {
        fail(at, "the number " + name, "a header line that names the columns",
             "put the columns' names in the first line");
      }
      if (!name.empty() && !seen.insert(name).second) {
        const auto first = std::find(cells.begin(), cells.end(), name) - cells.begin();
        fail(place(), "column \"" + name + "\" twice", "names that differ",
             "rename column " + std::to_string(first + 1) + " or column " + std::to_string(i + 1) +
                 " in the header, or leave one of them out");
      }
      layout_.names.push_back(name);
    }
  }

  RecordingFile& file_;
  CsvLayout layout_;
  Line newest_;
  std::deque<Line> ahead_;  // read, and not taken yet
  std::size_t line_ = 0;
  std::size_t lines_read_ = 0;  // with those ahead
  bool is_told_as_windows_ = false;
  std::string comment_;
  std::size_t comment_line_ = 0;
};

}  // namespace

bool is_comment(std::string_view line) {
  const std::size_t at = line.find_first_not_of(" \t");
  return at != std::string_view::npos && (line[at] == '#' || line[at] == '%');
}

bool is_blank_line(std::string_view line) {
  return line.find_first_not_of(" \t") == std::string_view::npos;
}

CsvLayout read_csv_layout(RecordingFile& file) { return LayoutReader(file).read(); }

}  // namespace offnominal::desk
