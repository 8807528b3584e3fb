#pragma once

#include <optional>
#include <string_view>

namespace offnominal::desk::exchange {

/// An angle in rad that is written as a share of a half turn: "pi", "-pi/2", "2*pi/3", "2 pi / 3",
/// "0.5pi", "3/4 pi"; none for any other text, plain numbers included.
[[nodiscard]] std::optional<double> share_of_pi(std::string_view text);

}  // namespace offnominal::desk::exchange
