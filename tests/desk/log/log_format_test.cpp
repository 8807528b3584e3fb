#include "log/log_format.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "desk/support/temporary_folder.hpp"
#include "support/places.hpp"

namespace offnominal::desk {
namespace {

std::string format_of(const std::string& name, const std::string& content) {
  const test::TemporaryFolder folder;
  test::put(folder / name, content);
  return log_format_of(RecordingFile(folder / name)).name;
}

TEST(LogFormat, IsToldByContentAndExtension) {
  EXPECT_EQ(format_of("a.csv", "t,q1,tau1\n0,0,0\n"), "CSV");
  EXPECT_EQ(format_of("a.txt", "MATLAB 5.0 MAT-file"), "MATLAB .mat");
  EXPECT_EQ(format_of("a.MAT", "damaged"), "MATLAB .mat");
  EXPECT_EQ(format_of("a.csv", "(12.000345) vcan0 181#2A36FF\n"), "candump -l");
  EXPECT_EQ(format_of("a.log", ""), "CSV");
}

TEST(LogFormat, HasOneForFilesThatNoOtherRecognises) {
  const auto formats = log_formats();
  EXPECT_EQ(std::count_if(formats.begin(), formats.end(),
                          [](const LogFormat& format) { return format.recognises == nullptr; }),
            1);
}

TEST(LogFormat, IsNamedInTheGuides) {
  for (const char* guide : {"README.md", "docs/compare-and-add.md", "docs/robot-file.md"}) {
    std::string text = test::content_of(test::source_dir() / guide);
    std::erase(text, '`');
    for (const LogFormat& format : log_formats()) {
      EXPECT_THAT(text, testing::HasSubstr(format.name)) << guide;
    }
  }
}

}  // namespace
}  // namespace offnominal::desk
