#pragma once

#include <optional>
#include <string>

#include "robot/robot.hpp"

namespace offnominal::desk {

/// `old_text`, a robot file, with the uncertainty bound of `robot` in place of its own, or behind
/// the last line where it has none; without it where `robot` has none. The comment that stands
/// right above an old bound goes with it, because it speaks of the old numbers; every other line
/// stays. A bound in one line, uncertainty_bound = {...} or uncertainty_bound.kind = "...", goes
/// with the comment behind it and without what stands above, and the new one follows the last line
/// of the file. A bound that did not change stays as it is written. None where the text is no robot
/// file, where `robot` differs from it in more than its bound, or where the old bound cannot be cut
/// by lines. `file`: what the text is for; a path in it is relative to that file's folder.
[[nodiscard]] std::optional<std::string> text_with_bound(const std::string& old_text,
                                                         const RobotDescription& robot,
                                                         const std::string& file = {});

}  // namespace offnominal::desk
