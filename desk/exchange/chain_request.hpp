#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace offnominal::desk::exchange {

/// Which chain of a URDF's tree is meant, by its links.
struct ChainRequest {
  std::optional<std::string> base = std::nullopt;  // none: the root
  std::optional<std::string> tip = std::nullopt;   // none: where the only chain of joints ends
};

/// The options of `import-urdf` that say so: " --base world --tip hand"; empty: none.
[[nodiscard]] std::string options_of(const ChainRequest& request);

/// A chain that a URDF has.
struct ChainChoice {
  std::string base;
  std::string tip;
  std::size_t joints = 0;  // that move
};

}  // namespace offnominal::desk::exchange
