// Files of several parts, whose plain rows several threads read: what comes out is what one reader
// makes of them line by line.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <string>

#include "common/error.hpp"
#include "desk/support/temporary_file.hpp"
#include "log/csv_lines.hpp"
#include "log/csv_log.hpp"

namespace {

using Eigen::Index;
using offnominal::desk::CsvLines;
using offnominal::desk::InputError;
using offnominal::desk::NamedColumns;
using offnominal::desk::Need;
using offnominal::desk::read_csv;
using offnominal::test::message_of;
using offnominal::test::TemporaryFile;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

// So many rows have three parts and a bit.
constexpr int kRows = 400'000;

double q_at(int row) { return 0.1 + 0.25 * (row % 1000); }

std::string row_text(int row) { return fmt::format("{},{:.4f},{}\n", row, q_at(row), row % 7); }

// `line(row, text)` may change a row's text, or put lines before it.
template <typename Change>
std::string table(const Change& change) {
  std::string text = "t,q1,tau1\n";
  for (int row = 0; row < kRows; ++row) {
    std::string line = row_text(row);
    change(row, line);
    text += line;
  }
  return text;
}

Need need_of(const std::string& name) { return name == "t" ? Need::kAscending : Need::kRequired; }

NamedColumns read(const std::string& text) {
  const TemporaryFile file("long.csv", text);
  return read_csv(file.path(), need_of);
}

std::string refusal(const std::string& text) {
  return message_of<InputError>([&] { static_cast<void>(read(text)); });
}

void expect_rows(const NamedColumns& columns, int rows) {
  ASSERT_EQ(columns.columns.at("q1").size(), rows);
  for (int row = 0; row < rows; ++row) {
    ASSERT_EQ(columns.columns.at("t")[row], row);
    ASSERT_NEAR(columns.columns.at("q1")[row], q_at(row), 1e-12);
    ASSERT_EQ(columns.columns.at("tau1")[row], row % 7);
  }
}

TEST(LongCsv, IsReadInSeveralParts) {
  const std::string text = table([](int, std::string&) {});
  ASSERT_GT(text.size(), 3 * sizeof(char) * CsvLines::kBytes / 2);
  expect_rows(read(text), kRows);
}

TEST(LongCsv, LinesThatHoldNoRowMoveNothingBehindThem) {
  const NamedColumns columns = read(table([](int row, std::string& line) {
    if (row % 50'000 == 17) line = "# " + std::to_string(row) + "\n" + line;
    if (row == 250'000) line = "\n" + line;
  }));
  expect_rows(columns, kRows);
  EXPECT_EQ(columns.place_of(10), "line 12");
  EXPECT_EQ(columns.place_of(17), "line 20");
  // Behind the header, seven comments and a blank line.
  EXPECT_EQ(columns.place_of(kRows - 1), fmt::format("line {}", kRows + 1 + 8 + 1));
}

TEST(LongCsv, WhatIsNoNumberIsNamedWithItsLine) {
  const std::string text = table([](int row, std::string& line) {
    if (row == 333'333) line = "333333,abc,1\n";
    if (row == 5) line = "# a comment\n" + line;
  });
  EXPECT_THAT(refusal(text), AllOf(HasSubstr(fmt::format("line {}", 333'333 + 3)),
                                   HasSubstr("column q1"), HasSubstr("\"abc\"")));
}

TEST(LongCsv, TheFirstOfTwoFaultsIsSaid) {
  const std::string text = table([](int row, std::string& line) {
    if (row == 200'000) line = "200000,abc,1\n";
    if (row == 200'001) line = std::string("200001,\0,1\n", 11);
  });
  EXPECT_THAT(refusal(text), HasSubstr("\"abc\""));
  const std::string other = table([](int row, std::string& line) {
    if (row == 200'001) line = std::string("200001,\0,1\n", 11);
  });
  EXPECT_THAT(refusal(other), HasSubstr("no text"));
}

TEST(LongCsv, IsReadAsFarAsTimeAscends) {
  const NamedColumns columns = read(table([](int row, std::string& line) {
    // Behind it a fault that nobody comes to.
    if (row >= 300'000) line = row_text(row - 300'000);
    if (row == kRows - 1) line = "x,y,z\n";
  }));
  EXPECT_THAT(columns.remarks, Contains(HasSubstr("the time is not later than before")));
  ASSERT_GE(columns.columns.at("q1").size(), 300'000);
  EXPECT_LT(columns.columns.at("q1").size(), kRows - 1);
  for (int row = 0; row < 300'000; ++row) ASSERT_EQ(columns.columns.at("t")[row], row);
}

TEST(LongCsv, DecimalCommasAreKnownFromTheFirstOn) {
  std::string text = "t;q1;tau1\n";
  for (int row = 0; row < kRows; ++row) {
    std::string q = fmt::format("{:.4f}", q_at(row));
    q[q.find('.')] = ',';
    text += fmt::format("{};{};{}\n", row, q, row % 7);
  }
  expect_rows(read(text), kRows);
}

TEST(LongCsv, AMarkThatMayStandBeforeThousandsIsFoundInAnyPart) {
  std::string text = "t;q1;tau1\n";
  for (int row = 0; row < kRows; ++row) {
    const std::string q = row == 350'000 ? "1,371" : fmt::format("{:.4f}", q_at(row));
    text += fmt::format("{};{};{}\n", row, q, row % 7);
  }
  EXPECT_THAT(refusal(text), AllOf(HasSubstr("1,371 of column q1"), HasSubstr("line 350002")));
}

TEST(LongCsv, ALastLineThatIsCutOffIsLeftOut) {
  std::string text = table([](int, std::string&) {});
  text += std::to_string(kRows) + ",0.1";
  const NamedColumns columns = read(text);
  expect_rows(columns, kRows);
  EXPECT_THAT(columns.remarks, Contains(HasSubstr("cut off")));
}

}  // namespace
