#pragma once

#include <filesystem>

#include "support/places.hpp"

namespace offnominal::test {

// The robot files of the project.
inline const std::filesystem::path kRobots = source_dir() / "robots";

}  // namespace offnominal::test
