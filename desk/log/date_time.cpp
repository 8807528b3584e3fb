#include "log/date_time.hpp"

#include <chrono>

namespace offnominal::desk {
namespace {

// Takes digits off the front of `text`, exactly `count`; negative where there are others.
int digits(std::string_view& text, std::size_t count) {
  if (text.size() < count) return -1;
  int value = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (text[i] < '0' || text[i] > '9') return -1;
    value = 10 * value + (text[i] - '0');
  }
  text.remove_prefix(count);
  return value;
}

bool take(std::string_view& text, std::string_view any_of) {
  if (text.empty() || any_of.find(text.front()) == std::string_view::npos) return false;
  text.remove_prefix(1);
  return true;
}

// Of a second, as far as nanoseconds go.
std::int64_t fraction_ns(std::string_view& text) {
  std::int64_t value = 0;
  std::int64_t weight = 100'000'000;
  while (!text.empty() && text.front() >= '0' && text.front() <= '9') {
    value += weight * (text.front() - '0');
    weight /= 10;
    text.remove_prefix(1);
  }
  return value;
}

std::optional<std::chrono::minutes> offset_of(std::string_view text) {
  if (text.empty() || text == "Z" || text == "z") return std::chrono::minutes(0);
  const bool west = text.front() == '-';
  if (!take(text, "+-")) return std::nullopt;
  const int hours = digits(text, 2);
  const bool has_minutes = !text.empty();
  if (has_minutes) take(text, ":");
  const int minutes = has_minutes ? digits(text, 2) : 0;
  if (hours < 0 || hours > 23 || minutes < 0 || minutes > 59 || !text.empty()) return std::nullopt;
  const std::chrono::minutes offset(60 * hours + minutes);
  return west ? -offset : offset;
}

// Takes one or two digits off the front of `text`.
int short_number(std::string_view& text) {
  const bool two = text.size() > 1 && text[1] >= '0' && text[1] <= '9';
  return digits(text, two ? 2 : 1);
}

struct Date {
  int year = -1;
  int month = -1;
  int day = -1;
};

// 2026-11-24, or as it is written in much of Europe, 24.11.2026. With other marks nobody can tell
// the day from the month.
std::optional<Date> take_date(std::string_view& text) {
  Date date;
  const std::size_t mark = text.find_first_not_of("0123456789");
  if (mark != std::string_view::npos && text[mark] == '.') {
    date.day = short_number(text);
    if (!take(text, ".")) return std::nullopt;
    date.month = short_number(text);
    if (!take(text, ".")) return std::nullopt;
    date.year = digits(text, 4);
  } else {
    date.year = digits(text, 4);
    if (!take(text, "-")) return std::nullopt;
    date.month = digits(text, 2);
    if (!take(text, "-")) return std::nullopt;
    date.day = digits(text, 2);
  }
  const bool is_date = date.year >= 1700 && date.year <= 2250 && date.month >= 0 && date.day >= 0;
  return is_date ? std::optional(date) : std::nullopt;
}

}  // namespace

std::optional<std::int64_t> date_time_ns(std::string_view text) {
  const std::optional<Date> day = take_date(text);
  if (!day || !take(text, "Tt ")) return std::nullopt;
  const int hour = digits(text, 2);
  if (hour < 0 || hour > 23 || !take(text, ":")) return std::nullopt;
  const int minute = digits(text, 2);
  if (minute < 0 || minute > 59 || !take(text, ":")) return std::nullopt;
  const int second = digits(text, 2);
  if (second < 0 || second > 60) return std::nullopt;
  std::int64_t fraction = 0;
  if (take(text, ".,")) {
    if (text.empty() || text.front() < '0' || text.front() > '9') return std::nullopt;
    fraction = fraction_ns(text);
  }
  const auto offset = offset_of(text);
  const std::chrono::year_month_day date{std::chrono::year(day->year),
                                         std::chrono::month(static_cast<unsigned>(day->month)),
                                         std::chrono::day(static_cast<unsigned>(day->day))};
  if (!offset || !date.ok()) return std::nullopt;
  const auto time = std::chrono::sys_days(date).time_since_epoch() + std::chrono::hours(hour) +
                    std::chrono::minutes(minute) + std::chrono::seconds(second) - *offset;
  return std::chrono::duration_cast<std::chrono::nanoseconds>(time).count() + fraction;
}

}  // namespace offnominal::desk
