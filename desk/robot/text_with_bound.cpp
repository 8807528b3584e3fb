#include "robot/text_with_bound.hpp"

#include <toml++/toml.h>

#include <cstddef>

#include "common/error.hpp"
#include "robot/bound_text.hpp"
#include "robot/robot_file.hpp"
#include "robot/text_lines.hpp"

namespace offnominal::desk {
namespace {

// Line of the bound's header, from 0; lines.size() where there is no bound, none where there is one
// that is not a table of its own.
std::optional<std::size_t> header_of_bound(const std::string& text, const Lines& lines) {
  const toml::table document = toml::parse(text);
  const toml::table* table = document["uncertainty_bound"].as_table();
  if (table == nullptr) return lines.size();
  const std::size_t line = table->source().begin.line;
  if (line < 1 || line > lines.size()) return std::nullopt;
  if (!trimmed(lines[line - 1]).starts_with("[uncertainty_bound]")) return std::nullopt;
  return line - 1;
}

// Behind the bound and the tables that belong to it, [[uncertainty_bound.over_speed]].
std::size_t end_of_bound(const Lines& lines, std::size_t header) {
  std::size_t end = end_of_block(lines, header);
  for (std::size_t next = end; next < lines.size(); ++next) {
    if (!is_header(lines[next])) continue;
    if (!trimmed(lines[next]).starts_with("[[uncertainty_bound.")) break;
    end = end_of_block(lines, next);
    next = end - 1;
  }
  return end;
}

std::string with_block(const Lines& lines, std::size_t header, const std::string& block) {
  LineComposer out(lines);
  std::size_t begin = header;
  while (begin > 0 && header < lines.size() && is_comment(lines[begin - 1])) --begin;
  out.copy_until(begin);
  out.insert(block);
  if (header < lines.size()) out.skip_to(end_of_bound(lines, header));
  out.copy_until(lines.size());
  return out.text();
}

}  // namespace

std::optional<std::string> text_with_bound(const std::string& old_text,
                                           const RobotDescription& robot, const std::string& file) {
  if (!robot.bound) return std::nullopt;
  try {
    const RobotDescription old = parse_robot(old_text, file);
    const std::string block = bound_text(*robot.bound);
    if (old.bound && bound_text(*old.bound) == block) {
      return robot_text(old) == robot_text(robot) ? std::optional(old_text) : std::nullopt;
    }
    const Lines lines = lines_of(old_text);
    const auto header = header_of_bound(old_text, lines);
    if (!header) return std::nullopt;
    std::string text = with_block(lines, *header, block);
    // Catches everything at once: other changes than the bound, cuts in the wrong place.
    if (robot_text(parse_robot(text, file)) != robot_text(robot)) return std::nullopt;
    return text;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace offnominal::desk
