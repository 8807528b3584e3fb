#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace offnominal::desk {

/// More than any file that people write by hand has.
inline constexpr std::size_t kMostText = std::size_t{64} << 20;  // bytes

/// The whole content of a file. Throws InputError when it is missing, a folder, unreadable or
/// longer than kMostText: some have no end.
[[nodiscard]] std::string read_text_file(const std::filesystem::path& path);

enum class Existing { kReplace, kRefuse };

/// What a verb's --force says about files that are there.
[[nodiscard]] constexpr Existing existing_if(bool force) {
  return force ? Existing::kReplace : Existing::kRefuse;
}

/// Writes `content` to `path`, which then holds either all of it or what it held before: a
/// temporary file in the same folder, flushed, then moved in one step. A symbolic link is followed.
/// With Existing::kRefuse a file that is there, even one that appears meanwhile, is left alone.
/// Throws InputError naming the path when the folder is missing or not writable, the disk is full,
/// the path is something other than a regular file, or the file exists and must not be replaced,
/// or is kept as it is.
void write_file_atomically(const std::filesystem::path& path, std::string_view content,
                           Existing existing = Existing::kRefuse);

/// Says that a file was read that nobody can make again, as a recording: from then on, for as long
/// as the process lives, write_file_atomically() refuses to replace it under any of its names.
void keep_as_it_is(const std::filesystem::path& path);

/// Throws the same InputError, as far as it can be known before there is anything to write; a file
/// that is there is no reason.
void check_can_be_written(const std::filesystem::path& path);

}  // namespace offnominal::desk
