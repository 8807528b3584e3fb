#pragma once

#include <cstddef>
#include <string>

namespace offnominal::desk {

/// "1 joint", "0 joints", "7 joints"; `plural` where an s is not enough.
[[nodiscard]] std::string counted(std::size_t count, const std::string& noun,
                                  const std::string& plural = {});

/// A finite value in so many significant digits, 1 to 15, written out where that takes at most six
/// digits before the point and three zeros behind it: "280", "0.0012", "1.5e+07".
[[nodiscard]] std::string significant(double value, int digits);

}  // namespace offnominal::desk
