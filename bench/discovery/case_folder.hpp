#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <system_error>

#include "common/error.hpp"

namespace offnominal::bench {

// Makes the folder that a case of a group is written to. Throws InputError where it is there
// already.
inline std::filesystem::path new_case_folder(const std::filesystem::path& folder,
                                             const std::string& group, std::size_t number) {
  std::filesystem::path own = folder / fmt::format("{}-{:03}", group, number);
  std::error_code failed;
  const bool is_new = std::filesystem::create_directories(own, failed);
  if (failed || !is_new) {
    throw desk::InputError({own.string(), "",
                            failed ? failed.message() : "a folder that is there already",
                            "a new folder", "name another one with --write"});
  }
  return own;
}

}  // namespace offnominal::bench
