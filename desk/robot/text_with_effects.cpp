#include "robot/text_with_effects.hpp"

#include <toml++/toml.h>

#include <cstddef>
#include <string_view>
#include <vector>

#include "common/error.hpp"
#include "robot/effect_text.hpp"
#include "robot/robot_file.hpp"
#include "robot/text_lines.hpp"

namespace offnominal::desk {
namespace {

struct Block {
  std::size_t begin;  // line of [[effect]], from 0
  std::size_t end;    // behind its last key
};

std::optional<std::vector<Block>> effect_blocks(const std::string& text, const Lines& lines) {
  std::vector<Block> blocks;
  const toml::table document = toml::parse(text);
  const toml::array* effects = document["effect"].as_array();
  for (std::size_t i = 0; effects != nullptr && i < effects->size(); ++i) {
    const std::size_t line = effects->get(i)->source().begin.line;
    if (line < 1 || line > lines.size() || !trimmed(lines[line - 1]).starts_with("[[")) {
      return std::nullopt;
    }
    blocks.push_back({line - 1, end_of_block(lines, line - 1)});
  }
  return blocks;
}

// Where the first effect of a file goes: above the settings that follow the joints, with the
// comment that introduces them.
std::size_t place_for_first_effect(const Lines& lines) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string_view line = trimmed(lines[i]);
    if (!line.starts_with("[estimator]") && !line.starts_with("[uncertainty_bound]") &&
        !line.starts_with("[transmission]") && !line.starts_with("[drives]") &&
        !line.starts_with("[channels]")) {
      continue;
    }
    while (i > 0 && is_comment(lines[i - 1])) --i;
    return i;
  }
  return lines.size();
}

std::string compose(const Lines& lines, const std::vector<Block>& blocks,
                    const RobotDescription& old, const RobotDescription& robot) {
  LineComposer out(lines);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    out.copy_until(blocks[i].begin);
    const bool kept = i < robot.effects.size();
    if (kept && effect_text(robot.effects[i]) == effect_text(old.effects[i])) {
      out.copy_until(blocks[i].end);
    } else {
      if (kept) out.insert(effect_text(robot.effects[i]));
      out.skip_to(blocks[i].end);
    }
  }
  if (blocks.empty()) out.copy_until(place_for_first_effect(lines));
  for (std::size_t i = blocks.size(); i < robot.effects.size(); ++i) {
    out.insert(effect_text(robot.effects[i]));
  }
  if (robot.effects.size() > blocks.size()) out.blank_line_unless_at_end();
  out.copy_until(lines.size());
  return out.text();
}

}  // namespace

std::optional<std::string> text_with_effects(const std::string& old_text,
                                             const RobotDescription& robot,
                                             const std::string& file) {
  try {
    const RobotDescription old = parse_robot(old_text, file);
    const Lines lines = lines_of(old_text);
    const auto blocks = effect_blocks(old_text, lines);
    if (!blocks) return std::nullopt;
    const std::string text = compose(lines, *blocks, old, robot);
    // Catches everything at once: other changes than effects, cuts in the wrong place.
    if (robot_text(parse_robot(text, file)) != robot_text(robot)) return std::nullopt;
    return text;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace offnominal::desk
