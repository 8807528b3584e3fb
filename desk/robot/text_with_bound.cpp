#include "robot/text_with_bound.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "common/error.hpp"
#include "robot/bound_text.hpp"
#include "robot/robot_file.hpp"
#include "robot/text_lines.hpp"

namespace offnominal::desk {
namespace {

// Lines from `begin` to before `end`, from 0.
struct LineRange {
  std::size_t begin;
  std::size_t end;
};

// A header may have blanks within its brackets.
std::string header_of(const std::string& line) {
  std::string header(trimmed(line));
  header.erase(std::remove(header.begin(), header.end(), ' '), header.end());
  return header;
}

// The bound and the tables that belong to it, [[uncertainty_bound.over_speed]],
// [uncertainty_bound.fast], wherever they stand, each with the comment above it.
std::vector<LineRange> blocks_of_bound(const Lines& lines) {
  std::vector<LineRange> blocks;
  for (std::size_t line = 0; line < lines.size(); ++line) {
    if (!is_header(lines[line])) continue;
    const std::string name = header_of(lines[line]);
    const bool belongs = name.starts_with("[uncertainty_bound]") ||
                         name.starts_with("[[uncertainty_bound.") ||
                         name.starts_with("[uncertainty_bound.");
    if (!belongs) continue;
    std::size_t begin = line;
    const std::size_t before = blocks.empty() ? 0 : blocks.back().end;
    while (begin > before && is_comment(lines[begin - 1])) --begin;
    blocks.push_back({begin, end_of_block(lines, line)});
    line = blocks.back().end - 1;
  }
  return blocks;
}

// Of a key and its value, which may go over several lines; none where the line has more before it.
std::optional<LineRange> lines_of_key(const toml::node& value, const Lines& lines) {
  const toml::source_region& source = value.source();
  const std::size_t begin = source.begin.line;
  const std::size_t end = std::max<std::size_t>(begin, source.end.line);
  if (begin < 1 || end > lines.size()) return std::nullopt;
  if (!trimmed(lines[begin - 1]).starts_with("uncertainty_bound")) return std::nullopt;
  return LineRange{begin - 1, end};
}

// Where the old bound stands: under headers, or as {...} or dotted keys above all headers; no range
// where there is none.
struct OldBound {
  std::vector<LineRange> ranges;
  bool under_header = false;
};

// Nothing where it stands otherwise.
std::optional<OldBound> old_bound_of(const std::string& text, const Lines& lines) {
  const toml::table document = toml::parse(text);
  const toml::table* table = document["uncertainty_bound"].as_table();
  OldBound old;
  if (table == nullptr) return old;
  const std::size_t line = table->source().begin.line;
  if (line >= 1 && line <= lines.size() &&
      header_of(lines[line - 1]).starts_with("[uncertainty_bound]")) {
    return OldBound{blocks_of_bound(lines), true};
  }
  const auto add = [&](const toml::node& value) {
    const auto range = lines_of_key(value, lines);
    if (range) old.ranges.push_back(*range);
    return range.has_value();
  };
  if (table->is_inline()) return add(*table) ? std::optional(old) : std::nullopt;
  for (const auto& [key, value] : *table) {
    if (!add(value)) return std::nullopt;
  }
  std::sort(old.ranges.begin(), old.ranges.end(),
            [](const LineRange& a, const LineRange& b) { return a.begin < b.begin; });
  return old;
}

// In the place of the first of the old ones. Above all headers a table would take the keys that
// follow it.
std::string with_block(const Lines& lines, const OldBound& old, const std::string& block) {
  LineComposer out(lines);
  bool is_there = block.empty();
  for (const LineRange& range : old.ranges) {
    out.copy_until(range.begin);
    if (old.under_header && !is_there) {
      out.insert(block);
      is_there = true;
    }
    out.skip_to(range.end);
  }
  out.copy_until(lines.size());
  if (!is_there) out.insert(block);
  return out.text();
}

}  // namespace

std::optional<std::string> text_with_bound(const std::string& old_text,
                                           const RobotDescription& robot, const std::string& file) {
  try {
    const RobotDescription old = parse_robot(old_text, file);
    const std::string block = robot.bound ? bound_text(*robot.bound) : "";
    if ((old.bound ? bound_text(*old.bound) : "") == block) {
      return robot_text(old) == robot_text(robot) ? std::optional(old_text) : std::nullopt;
    }
    const Lines lines = lines_of(old_text);
    const auto old_bound = old_bound_of(old_text, lines);
    if (!old_bound) return std::nullopt;
    std::string text = with_block(lines, *old_bound, block);
    // Catches everything at once: other changes than the bound, cuts in the wrong place.
    if (robot_text(parse_robot(text, file)) != robot_text(robot)) return std::nullopt;
    return text;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace offnominal::desk
