#pragma once

namespace offnominal {

/// The project's one version number: the CMake package and `offnominal --version` read it from
/// here.
inline constexpr int kVersionMajor = 0;
inline constexpr int kVersionMinor = 1;
inline constexpr int kVersionPatch = 0;

}  // namespace offnominal
