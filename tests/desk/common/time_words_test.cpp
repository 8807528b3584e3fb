#include "common/time_words.hpp"

#include <gtest/gtest.h>

namespace offnominal::desk {
namespace {

TEST(WordsOfTime, HaveSixDigitsOrATenthOfAMillisecond) {
  EXPECT_EQ(words_of_time(0), "0");
  EXPECT_EQ(words_of_time(2.40012345), "2.40012");
  EXPECT_EQ(words_of_time(1200), "1200");
  EXPECT_EQ(words_of_time(12345.678), "12345.678");
  EXPECT_EQ(words_of_time(1749429322.1234), "1749429322.1234");
  EXPECT_EQ(words_of_time(-250.5), "-250.5");
}

}  // namespace
}  // namespace offnominal::desk
