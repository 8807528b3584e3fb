#include "log/split_time.hpp"

#include <utility>

#include "log/date_time.hpp"

namespace offnominal::desk {

bool is_day(std::string_view text) {
  return date_time_ns(std::string(text) + " 00:00:00").has_value();
}

bool is_clock(std::string_view text) {
  return date_time_ns("2000-01-01 " + std::string(text)).has_value();
}

std::optional<std::size_t> other_half_of(const std::vector<std::string>& cells, std::size_t half) {
  const bool has_day = is_day(cells[half]);
  if (!has_day && !is_clock(cells[half])) return std::nullopt;
  const auto distance = [half](std::size_t i) { return i < half ? half - i : i - half; };
  std::optional<std::size_t> nearest;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const bool is_other = has_day ? is_clock(cells[i]) : is_day(cells[i]);
    if (is_other && (!nearest || distance(i) < distance(*nearest))) nearest = i;
  }
  return nearest;
}

std::string whole_time(std::string_view half, std::string_view other) {
  if (!is_day(half)) std::swap(half, other);
  return std::string(half) + " " + std::string(other);
}

}  // namespace offnominal::desk
