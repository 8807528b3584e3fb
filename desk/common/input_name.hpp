#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace offnominal::desk {

// Whether what a command line names as an input is gone once it was read: standard input, which "-"
// names too, a pipe, or a shell's <(...). No command can read it again.
bool is_stream(const std::string& file);

// "-": standard input, where a recording is asked for.
bool names_standard_input(const std::filesystem::path& file);

// The files of a recording that "positions.csv+currents.csv" names. A '+' may be part of a name:
// each file is the longest that is there, else as far as the next '+'. The one, where a file has
// that whole name, or there is no '+'.
std::vector<std::filesystem::path> recording_files(const std::filesystem::path& recording);

// A recording as messages name it: its path, or "standard input" for "-".
std::string shown_name(const std::filesystem::path& file);

// An input's name without its folder, in words that outlive the run: "standard input", "a pipe",
// "positions.csv+currents.csv".
std::string input_name(const std::string& file);

/// ".csv", in small letters; empty: none.
[[nodiscard]] std::string extension_of(const std::filesystem::path& file);

}  // namespace offnominal::desk
