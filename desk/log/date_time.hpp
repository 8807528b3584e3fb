#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace offnominal::desk {

// Nanoseconds since 1970-01-01T00:00:00Z of a date and time of day in ISO 8601, the extended form:
// 2026-11-24T02:14:30.123456+01:00, or with the date as 24.11.2026. A blank may stand for the T, a
// comma for the point; without an offset it is UTC. No leap seconds. None for any other text, and
// outside of 1700 to 2250.
[[nodiscard]] std::optional<std::int64_t> date_time_ns(std::string_view text);

}  // namespace offnominal::desk
