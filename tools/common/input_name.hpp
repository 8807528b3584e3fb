#pragma once

#include <filesystem>
#include <string>

namespace offnominal::tools {

// Whether what a command line names as an input is gone once it was read: standard input, which "-"
// names too, a pipe, or a shell's <(...). No command can read it again.
bool is_stream(const std::string& file);

// "-": standard input, where a recording is asked for.
bool names_standard_input(const std::filesystem::path& file);

// A recording as messages name it: its path, or "standard input" for "-".
std::string shown_name(const std::filesystem::path& file);

// An input's name without its folder, in words that outlive the run: "standard input", "a pipe".
std::string input_name(const std::string& file);

}  // namespace offnominal::tools
