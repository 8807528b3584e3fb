#pragma once

#include <optional>
#include <string>

#include "robot/robot.hpp"

namespace offnominal::desk {

/// `old_text`, a robot file, with the effects of `robot` in place of its own: effects that did not
/// change stay as they are written, changed ones are written anew where they stood, new ones follow
/// the last, and every other line stays, comments and order included. None where the text is no
/// robot file, where `robot` differs from it in more than its effects, or where it is written in a
/// way that cannot be cut by lines (effects as inline tables). `file`: what the text is for; a path
/// in it is relative to that file's folder.
[[nodiscard]] std::optional<std::string> text_with_effects(const std::string& old_text,
                                                           const RobotDescription& robot,
                                                           const std::string& file = {});

}  // namespace offnominal::desk
