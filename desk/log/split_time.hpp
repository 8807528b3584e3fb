#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace offnominal::desk {

// "2026-11-24", "24.11.2026": a date without a time of day.
[[nodiscard]] bool is_day(std::string_view text);
// "12:00:01.500": a time of day without a date.
[[nodiscard]] bool is_clock(std::string_view text);

// Which of a row's cells is the other half of the time whose one half, a date or a time of day,
// stands in cell `half`: the nearest. None where that cell is no half, or there is no other.
[[nodiscard]] std::optional<std::size_t> other_half_of(const std::vector<std::string>& cells,
                                                       std::size_t half);

// A date and a time of day, in either order, as date_time_ns() reads them.
[[nodiscard]] std::string whole_time(std::string_view half, std::string_view other);

}  // namespace offnominal::desk
