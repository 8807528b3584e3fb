#include "common/text_table.hpp"

#include <gtest/gtest.h>

#include <string>

namespace offnominal::desk {
namespace {

TEST(TextTable, HasOneWidthPerColumnForHeadingAndRows) {
  const TextTable table({{"joint", -6}, {"error", 8}, {"words", 0}});
  EXPECT_EQ(table.heading(), "joint     error words\n");
  EXPECT_EQ(table.row(1, "0.5 N", std::string("a b")), "1         0.5 N a b\n");
  EXPECT_EQ(table.row("longer than it", 123456789, ""), "longer than it 123456789 \n");
}

TEST(TextTable, BeginsLinesAndSeparatesCellsAsAsked) {
  const TextTable table({{"", -3}, {"n", 3}}, "  ", "|");
  EXPECT_EQ(table.heading(), "     |  n\n");
  EXPECT_EQ(table.line({"a", "1"}), "  a  |  1\n");
}

TEST(TextTable, TakesTheFirstColumnsAlone) {
  const TextTable table({{"a", -3}, {"b", 3}, {"c", 3}});
  EXPECT_EQ(table.row("x", 1), "x     1\n");
}

}  // namespace
}  // namespace offnominal::desk
