#pragma once

#include <optional>
#include <string>

#include "robot/robot.hpp"

namespace offnominal::desk {

/// The text of a robot file in which every joint's mass, centre of mass, inertia and `source` are
/// those of `robot`, and all else is as it was, comments too. None where these numbers cannot be
/// put there: a joint more or less, a key that stood nowhere, or a value over several lines.
[[nodiscard]] std::optional<std::string> text_with_joints(const std::string& old_text,
                                                          const RobotDescription& robot,
                                                          const std::string& file);

}  // namespace offnominal::desk
