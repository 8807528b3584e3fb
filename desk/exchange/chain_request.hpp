#pragma once

#include <optional>
#include <string>

namespace offnominal::desk::exchange {

/// Which chain of a URDF's tree is meant, by its links.
struct ChainRequest {
  std::optional<std::string> base = std::nullopt;  // none: the root
  std::optional<std::string> tip = std::nullopt;   // none: where the only chain of joints ends
};

}  // namespace offnominal::desk::exchange
