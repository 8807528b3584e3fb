#pragma once

#include <cstdlib>
#include <filesystem>

#include "support/places.hpp"

namespace offnominal::test {

/// Folder of the real recordings: OFFNOMINAL_DATA, else ../shared/data beside the checkout.
/// The folder may be absent; a test that needs a file of it is then skipped with the reason.
inline std::filesystem::path recordings_dir() {
  if (const char* folder = std::getenv("OFFNOMINAL_DATA"); folder != nullptr && *folder != '\0') {
    return folder;
  }
  return source_dir() / ".." / "shared" / "data";
}

}  // namespace offnominal::test
