#include "common/error.hpp"

#include <gtest/gtest.h>

namespace offnominal::desk {
namespace {

TEST(InputError, NamesFilePlaceFoundAllowedAndRemedyInOneLine) {
  const InputError error({"r.toml", "line 3, joint[1].link.mass_kg", "-1",
                          "a finite number > 0, in kg", "give the mass"});
  EXPECT_STREQ(error.what(),
               "r.toml: line 3, joint[1].link.mass_kg: found -1; allowed: a finite number > 0, in "
               "kg; to mend: give the mass");
  EXPECT_EQ(error.problem().allowed, "a finite number > 0, in kg");
}

TEST(InputError, LeavesOutEmptyParts) {
  EXPECT_STREQ(InputError({"r.toml", "", "a folder", "", ""}).what(), "r.toml: found a folder");
  EXPECT_STREQ(InputError({"", "", "", "", "try again"}).what(), "to mend: try again");
  EXPECT_STREQ(InputError({"", "", "", "", ""}).what(), "");
}

TEST(InputError, StaysOneLineWhateverTheInputHolds) {
  const InputError error({"a\nb", "c\r\nd", "e\tf\x1b[0m\x7f", "", ""});
  EXPECT_STREQ(error.what(), "a b: c  d: found e f [0m ");
}

TEST(OnOneLine, KeepsLettersBeyondAscii) { EXPECT_EQ(on_one_line("für\n"), "für "); }

}  // namespace
}  // namespace offnominal::desk
