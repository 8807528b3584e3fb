#pragma once

#include <string>

namespace offnominal::desk {

/// The shortest decimal text that is read back as the same double: "0.1", "-3", "1e+22", "nan".
[[nodiscard]] std::string shortest(double value);

/// The same with a point or an exponent, which TOML and C++ ask of a real number: "-3.0", "-0.0".
[[nodiscard]] std::string shortest_real(double value);

}  // namespace offnominal::desk
