#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace offnominal::tools {

/// The whole content of a file. Throws InputError when it is missing, a folder or unreadable.
[[nodiscard]] std::string read_text_file(const std::filesystem::path& path);

enum class Existing { kReplace, kRefuse };

/// Writes `content` to `path`, which then holds either all of it or what it held before: a
/// temporary file in the same folder, flushed, then moved in one step. A symbolic link is followed.
/// With Existing::kRefuse a file that is there, even one that appears meanwhile, is left alone.
/// Throws InputError naming the path when the folder is missing or not writable, the disk is full,
/// the path is something other than a regular file, or the file exists and must not be replaced.
void write_file_atomically(const std::filesystem::path& path, std::string_view content,
                           Existing existing = Existing::kReplace);

}  // namespace offnominal::tools
