#pragma once

#include <filesystem>
#include <string>

namespace CLI {
class App;
}

namespace offnominal::desk {

// One rule for every file that a program writes: it is new, or --force was given; and it is no
// other file of the command line, read or written. The exceptions are what everyday work asks for:
// a page that stands where a page is to be written again needs no --force, and with --force the
// robot file that --robot reads may be the one that is written.
//
// An option that names such a file says so by one of these as its type name, which its help shows.
inline constexpr const char* kNewFile = "NEW-FILE";
inline constexpr const char* kNewPage = "NEW-PAGE";
inline constexpr const char* kNewRobotFile = "NEW-ROBOT-FILE";

// Whether both name one file, there already or not.
bool same_file(const std::string& a, const std::string& b);

// Throws InputError, before any work is done, where an option of `verb` names a file that the rule
// does not let it write, or that cannot be written at all. `is_page` knows a page by its content.
void check_outputs(const CLI::App& verb,
                   bool (*is_page)(const std::filesystem::path& file) = nullptr);

}  // namespace offnominal::desk
