#include "identify/freedom.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace {

using offnominal::desk::Freedom;
using offnominal::desk::half_width_per_deviation;
using offnominal::desk::words_of_too_few;
using ::testing::HasSubstr;

TEST(Freedom, ThreeGroupsMoreThanNumbersSuffice) {
  EXPECT_TRUE((Freedom{13, 10}.suffices()));
  EXPECT_FALSE((Freedom{12, 10}.suffices()));
  EXPECT_FALSE((Freedom{0, 0}.suffices()));
}

// Two-sided 97.5 % quantiles of Student's t, from tables.
TEST(Freedom, TheFewerAreFreeTheWiderIsTheInterval) {
  EXPECT_NEAR(half_width_per_deviation({3, 0}), 3.1824, 1e-4);
  EXPECT_NEAR(half_width_per_deviation({1000000, 0}), 1.96, 1e-3);
  // The fit has taken three quarters of what four groups show of the spread.
  EXPECT_NEAR(half_width_per_deviation({12, 9}), 2 * 3.1824, 1e-3);
}

TEST(Freedom, TheWordsNameTheJointAndBothNumbers) {
  const std::string words = words_of_too_few({9, 8}, 2);
  EXPECT_THAT(words, HasSubstr("8 fitted numbers of joint 3"));
  EXPECT_THAT(words, HasSubstr("need 11 independent"));
  EXPECT_THAT(words, HasSubstr("found 9"));
}

}  // namespace
