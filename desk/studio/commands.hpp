#pragma once

#include <string>
#include <vector>

#include "studio/session_files.hpp"
#include "studio/workbench.hpp"

namespace offnominal::desk::studio {

/// The commands that make `output` of the robot file without Studio: an `add` for each step, and a
/// `compare` of what comes out. Empty where there is no step. No file that is there is written:
/// where `output` is, it is one of another name in that folder.
std::vector<std::string> commands_of(const Workbench& bench, const std::string& output);

/// Those that say what the robot file lacks by hold maps, and write a robot file with it: no
/// session is over them.
std::vector<std::string> commands_at_rest(const SessionFiles& files);

}  // namespace offnominal::desk::studio
