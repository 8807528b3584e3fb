#pragma once

#include <string>

namespace offnominal::tools {

/// The shortest decimal text that is read back as the same double: "0.1", "-3", "1e+22", "nan".
[[nodiscard]] std::string shortest(double value);

}  // namespace offnominal::tools
