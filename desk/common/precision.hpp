#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace offnominal::desk {

/// The controller's numbers: what `--scalar` chooses.
enum class Precision : std::uint8_t { kFloat, kDouble };

/// "float", "double".
[[nodiscard]] inline std::string name_of(Precision precision) {
  return precision == Precision::kFloat ? "float" : "double";
}
/// The inverse of name_of(); kDouble for any other name, which the command line lets nobody give.
[[nodiscard]] inline Precision precision_of(std::string_view name) {
  return name == "float" ? Precision::kFloat : Precision::kDouble;
}

}  // namespace offnominal::desk
