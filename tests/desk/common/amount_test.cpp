#include "common/amount.hpp"

#include <gtest/gtest.h>

namespace offnominal::desk {
namespace {

TEST(Counted, HasAnSBehindAllNumbersButOne) {
  EXPECT_EQ(counted(0, "joint"), "0 joints");
  EXPECT_EQ(counted(1, "joint"), "1 joint");
  EXPECT_EQ(counted(7, "joint"), "7 joints");
  EXPECT_EQ(counted(2, "stretch", "stretches"), "2 stretches");
  EXPECT_EQ(counted(1, "stretch", "stretches"), "1 stretch");
}

TEST(Significant, WritesNumbersOutWhereAReaderWouldCount) {
  EXPECT_EQ(significant(280.4, 2), "280");
  EXPECT_EQ(significant(0.2996, 2), "0.30");
  EXPECT_EQ(significant(99.96, 3), "100");
  EXPECT_EQ(significant(-1234.5, 3), "-1230");
  EXPECT_EQ(significant(0.00012, 2), "0.00012");
  EXPECT_EQ(significant(123456, 2), "120000");
  EXPECT_EQ(significant(1.5e7, 2), "1.5e+07");
  EXPECT_EQ(significant(1.5e-7, 2), "1.5e-07");
  EXPECT_EQ(significant(0, 3), "0");
}

}  // namespace
}  // namespace offnominal::desk
