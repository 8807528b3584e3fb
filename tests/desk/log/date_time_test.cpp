#include "log/date_time.hpp"

#include <gtest/gtest.h>

namespace {

using offnominal::desk::date_time_ns;

constexpr std::int64_t kSecond = 1'000'000'000;

// `date -d ... +%s` has the seconds.
TEST(DateTime, CountsFrom1970InUtc) {
  EXPECT_EQ(date_time_ns("1970-01-01T00:00:00Z"), 0);
  EXPECT_EQ(date_time_ns("2026-11-24T02:14:30Z"), 1795486470 * kSecond);
  EXPECT_EQ(date_time_ns("2024-02-29 12:00:00"), 1709208000 * kSecond);
  EXPECT_EQ(date_time_ns("1969-12-31T23:59:59"), -kSecond);
  EXPECT_EQ(date_time_ns("2026-11-24T02:14:30+01:30"), (1795486470 - 5400) * kSecond);
  EXPECT_EQ(date_time_ns("2026-11-24T02:14:30-0800"), (1795486470 + 28800) * kSecond);
}

TEST(DateTime, DayBeforeMonthHasDots) {
  EXPECT_EQ(date_time_ns("24.11.2026 02:14:30"), 1795486470 * kSecond);
  EXPECT_EQ(date_time_ns("24.11.2026 02:14:30,5"), 1795486470 * kSecond + kSecond / 2);
  EXPECT_EQ(date_time_ns("1.1.1970 00:00:01"), kSecond);
}

TEST(DateTime, FractionsGoDownToNanoseconds) {
  EXPECT_EQ(date_time_ns("1970-01-01T00:00:01.5Z"), kSecond + kSecond / 2);
  EXPECT_EQ(date_time_ns("1970-01-01T00:00:00,000000001"), 1);
  EXPECT_EQ(date_time_ns("1970-01-01T00:00:00.1234567899"), 123456789);
}

TEST(DateTime, AnyOtherTextIsNone) {
  for (const char* text : {"",
                           "2026",
                           "2026-11-24",
                           "2026-11-24T02:14",
                           "2026-02-30T00:00:00",
                           "2026-13-01T00:00:00",
                           "2026-11-24T24:00:00",
                           "2026-11-24T02:60:00",
                           "2026-11-24T02:14:30.",
                           "0026-11-24T02:14:30",
                           "2026-11-24T02:14:30X",
                           "2026-11-24T02:14:30+1",
                           "2026-11-24T02:14:30+01:00:00",
                           "9999-11-24T02:14:30",
                           "1.5",
                           "24.11.26 02:14:30",
                           "24/11/2026 02:14:30",
                           "24.13.2026 02:14:30",
                           "124.11.2026 02:14:30",
                           "24.11.2026",
                           "1.2.3",
                           ".1.2026 02:14:30"}) {
    EXPECT_FALSE(date_time_ns(text)) << text;
  }
}

}  // namespace
