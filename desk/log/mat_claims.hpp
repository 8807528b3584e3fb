#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace offnominal::desk {

// What a byte of the file can stand for: zlib packs by a factor of 1032 at most.
inline constexpr std::uint64_t kMostPerPackedByte = 1100;

// True where a file that begins so, with 128 bytes or more, has the header of MATLAB's level 5
// or 7.3. matio takes any other file for one of level 4, which has no header, and allocates what
// its first bytes claim.
bool is_mat_level_5_or_7(std::string_view beginning);

// What a variable of a MATLAB file of level 5 claims to hold, and cannot. matio allocates what
// dimensions, cell arrays, structures and function handles claim before it reads them, and goes as
// deep as they do.
struct ImpossibleClaim {
  std::string variable;  // its name; empty where the file ends before it, or it is damaged
  std::string what;      // "100663300 cells in 90 bytes"
};

// The first such claim in the file; none for files of other levels. Where a file ends early or
// holds fewer numbers than it says, matio gives what was in its memory before: each variable has to
// be there to its end, and to agree with its checksum where it is packed. Everything is read,
// unpacked where it is packed, and not kept. Format: MathWorks, "MAT-File Format", level 5.
std::optional<ImpossibleClaim> impossible_claim(const std::filesystem::path& path);

}  // namespace offnominal::desk
