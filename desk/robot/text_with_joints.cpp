#include "robot/text_with_joints.hpp"

#include <toml++/toml.h>

#include <array>
#include <cstddef>
#include <iterator>
#include <string_view>
#include <vector>

#include "robot/robot_file.hpp"
#include "robot/text_lines.hpp"

namespace offnominal::desk {
namespace {

constexpr std::array<const char*, 4> kPaths{"source", "link.mass_kg", "link.centre_of_mass_m",
                                            "link.inertia_kg_m2"};

std::size_t joints_in(const toml::table& document) {
  const toml::array* joints = document["joint"].as_array();
  return joints == nullptr ? 0 : joints->size();
}

const toml::node* node_of(const toml::table& document, std::size_t joint, const char* path) {
  return document["joint"][joint].node() == nullptr ? nullptr
                                                    : document["joint"][joint].at_path(path).node();
}

// Where a value stands in its line, in bytes.
struct Place {
  std::size_t line;  // from 0
  std::size_t begin;
  std::size_t count;
};

// Of a value in one line. Columns count characters.
std::optional<Place> value_place(const Lines& lines, const toml::node& node) {
  const toml::source_region& at = node.source();
  if (at.begin.line < 1 || at.begin.line != at.end.line || at.begin.line > lines.size()) {
    return std::nullopt;
  }
  const std::string& line = lines[at.begin.line - 1];
  const auto byte_of = [&](std::size_t column) {
    std::size_t byte = 0;
    for (std::size_t character = 1; byte < line.size() && character < column; ++character) {
      ++byte;
      while (byte < line.size() && (static_cast<unsigned char>(line[byte]) & 0xC0U) == 0x80U) {
        ++byte;
      }
    }
    return byte;
  };
  const std::size_t begin = byte_of(at.begin.column);
  return Place{at.begin.line - 1, begin, byte_of(at.end.column) - begin};
}

std::string text_at(const Lines& lines, const Place& place) {
  return lines[place.line].substr(place.begin, place.count);
}

// A robot as it is written, and where its values stand.
struct Written {
  explicit Written(const std::string& text) : document(toml::parse(text)), lines(lines_of(text)) {}
  toml::table document;
  Lines lines;
};

// The new value of a key that is another one than before; empty where it is the same. None where
// one of the two is not there, or not in one line.
std::optional<std::string> new_value(const Written& before, const Written& after, std::size_t joint,
                                     const char* path) {
  const toml::node* was = node_of(before.document, joint, path);
  const toml::node* is = node_of(after.document, joint, path);
  if (was == nullptr && is == nullptr) return "";
  if (is == nullptr) return std::nullopt;
  const auto at = value_place(after.lines, *is);
  if (!at) return std::nullopt;
  const std::string value = text_at(after.lines, *at);
  if (was == nullptr) return value;
  const auto at_before = value_place(before.lines, *was);
  if (!at_before) return std::nullopt;
  return text_at(before.lines, *at_before) == value ? "" : value;
}

// Puts a value in the place of the one that the file has; a `source` that it has not, behind the
// joint's name.
bool put(const toml::table& document, std::size_t joint, const char* path, const std::string& value,
         Lines& lines) {
  if (const toml::node* node = node_of(document, joint, path)) {
    const auto at = value_place(lines, *node);
    if (!at) return false;
    lines[at->line].replace(at->begin, at->count, value);
    return true;
  }
  const toml::node* name = node_of(document, joint, "name");
  if (std::string_view(path) != kPaths.front() || name == nullptr) return false;
  const auto at = value_place(lines, *name);
  if (!at) return false;
  lines[at->line] += std::string("\n") + path + " = " + value;
  return true;
}

}  // namespace

std::optional<std::string> text_with_joints(const std::string& old_text,
                                            const RobotDescription& robot,
                                            const std::string& file) {
  const Written before(robot_text(parse_robot(old_text, file)));
  const Written after(robot_text(robot));
  const toml::table document = toml::parse(old_text);
  const std::size_t joints = joints_in(document);
  if (joints != robot.joints.size()) return std::nullopt;
  Lines lines = lines_of(old_text);
  bool changes = false;
  for (std::size_t joint = 0; joint < joints; ++joint) {
    // Where two values share a line, as in a table within braces, the second is put in a wrong
    // place: text_with_effects() sees that the text is not the robot's.
    for (const char* path : kPaths) {
      const auto value = new_value(before, after, joint, path);
      if (!value) return std::nullopt;
      if (value->empty()) continue;
      if (!put(document, joint, path, *value, lines)) return std::nullopt;
      changes = true;
    }
  }
  if (!changes) return old_text;
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

}  // namespace offnominal::desk
