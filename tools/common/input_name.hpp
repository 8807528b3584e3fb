#pragma once

#include <string>

namespace offnominal::tools {

// Whether what a command line names as an input is gone once it was read: standard input, which "-"
// names too, a pipe, or a shell's <(...). No command can read it again.
bool is_stream(const std::string& file);

// An input's name without its folder, in words that outlive the run: "standard input", "a pipe".
std::string input_name(const std::string& file);

}  // namespace offnominal::tools
