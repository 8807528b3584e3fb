#include "codegen/cpp_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

namespace offnominal::desk::cpp_text {
namespace {

TEST(CppText, WritesNumbersThatKeepTheirTypeAndSign) {
  EXPECT_EQ(number(0.1), "Scalar(0.1)");
  EXPECT_EQ(number(-3), "Scalar(-3.0)");
  EXPECT_EQ(number(-0.0), "Scalar(-0.0)");
  EXPECT_EQ(number(1e-22), "Scalar(1e-22)");
  EXPECT_EQ(number(123456789012), "Scalar(123456789012.0)");
  EXPECT_EQ(numbers(std::vector<double>{1, 0.5}), "{Scalar(1.0), Scalar(0.5)}");
}

TEST(CppText, HoldsNumbersToWhatTheScalarHolds) {
  EXPECT_EQ(number(std::numeric_limits<double>::max()), "std::numeric_limits<Scalar>::max()");
  EXPECT_EQ(number(-std::numeric_limits<double>::max()), "-std::numeric_limits<Scalar>::max()");
  EXPECT_EQ(number(-1e300),
            "-Scalar(std::min(1e+300, static_cast<double>(std::numeric_limits<Scalar>::max())))");
}

TEST(CppText, EscapesWhatAStringLiteralCannotHold) {
  EXPECT_EQ(literal("joint 1"), "\"joint 1\"");
  EXPECT_EQ(literal("a\"b\\c\n?\xC3\xA4"), R"("a\"b\\c\012\?\303\244")");
}

TEST(CppText, KeepsRemarksInTheirComment) {
  EXPECT_EQ(comment(""), "");
  EXPECT_EQ(comment("two words"), "// two words\n");
  EXPECT_EQ(comment("ends in a backslash \\"), "// ends in a backslash \\.\n");
  EXPECT_EQ(comment("a\nb\tc\r\xE2\x80\xAE"
                    "d"),
            "// a b c d\n");
  EXPECT_EQ(comment("x", "  "), "  // x\n");
}

TEST(CppText, BreaksLongRemarksAtSpaces) {
  std::string text;
  for (int i = 0; i < 40; ++i) text += "word\\ ";
  const std::string lines = comment(text);
  std::size_t begin = 0;
  int words = 0;
  while (begin < lines.size()) {
    const std::size_t end = lines.find('\n', begin);
    const std::string line = lines.substr(begin, end - begin);
    EXPECT_LE(line.size(), 101U) << line;
    EXPECT_TRUE(line.starts_with("// word\\")) << line;
    EXPECT_TRUE(line.ends_with("\\.")) << line;
    for (std::size_t at = line.find("word"); at != std::string::npos;
         at = line.find("word", at + 1)) {
      ++words;
    }
    begin = end + 1;
  }
  EXPECT_EQ(words, 40);
}

TEST(CppText, KnowsWhatANamespaceMayBeCalled) {
  for (const char* good : {"robot_model", "a::b", "Arm7", "a::std"})
    EXPECT_TRUE(is_namespace(good)) << good;
  for (const char* bad : {"", "7arm", "a b", "a-b", "class", "a::", "::a", "a:b", "_a", "a__b",
                          "a::for", "\xC3\xA4", "NULL", "a::NAN", "std", "std::a"}) {
    EXPECT_FALSE(is_namespace(bad)) << bad;
  }
}

}  // namespace
}  // namespace offnominal::desk::cpp_text
