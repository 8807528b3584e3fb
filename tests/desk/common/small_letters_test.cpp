#include "common/small_letters.hpp"

#include <gtest/gtest.h>

namespace offnominal::desk {
namespace {

TEST(SmallLetters, AreThoseOfAsciiAlone) {
  EXPECT_EQ(in_small_letters("Pos_JOINT1 [mN m]"), "pos_joint1 [mn m]");
  EXPECT_EQ(in_small_letters("\u00c4\u03a9@[`{"), "\u00c4\u03a9@[`{");
  EXPECT_EQ(in_small_letters(""), "");
}

}  // namespace
}  // namespace offnominal::desk
