#pragma once

#include <filesystem>

namespace offnominal::test {

// The robot files of the project.
inline const std::filesystem::path kRobots =
    std::filesystem::path(OFFNOMINAL_SOURCE_DIR) / "robots";

}  // namespace offnominal::test
