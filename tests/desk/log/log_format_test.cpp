#include "log/log_format.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "common/error.hpp"
#include "desk/support/temporary_file.hpp"
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

TEST(LogFormat, WhatIsNotReadSaysWhatToExportInstead) {
  const auto refusal = [](const std::string& name, const std::string& content) {
    return test::message_of<InputError>([&] { static_cast<void>(format_of(name, content)); });
  };
  using testing::HasSubstr;
  const std::string archive = "PK\x03\x04\x14\x06";
  const std::string bytes = "\x01\x02";
  EXPECT_THAT(refusal("a.xlsx", archive),
              testing::AllOf(HasSubstr("a.xlsx: found a workbook of a spreadsheet; allowed: a "
                                       "recording: CSV, MATLAB .mat or candump -l; to mend: save"),
                             HasSubstr("as CSV")));
  EXPECT_THAT(refusal("A.H5", "\x89HDF\r\n\x1a\n"), HasSubstr("found an HDF5 file"));
  EXPECT_THAT(refusal("a.hdf5", bytes), HasSubstr("found an HDF5 file"));
  EXPECT_THAT(refusal("a.bag", "#ROSBAG V2.0\n" + bytes), HasSubstr("rostopic echo -b FILE -p"));
  EXPECT_THAT(refusal("a.mcap", "\x89MCAP0\r\n" + bytes), HasSubstr("ros2 topic echo --csv"));
  EXPECT_THAT(refusal("a.db3", "SQLite format 3" + bytes), HasSubstr("a bag of ROS 2"));
  EXPECT_THAT(refusal("a.parquet", "PAR1" + bytes), HasSubstr("to_csv"));
  EXPECT_THAT(refusal("a.xls", bytes), HasSubstr("a workbook"));
  EXPECT_THAT(refusal("a.npz", archive), HasSubstr("numpy.savetxt"));
  // By whatever name it comes, and none that is text.
  EXPECT_THAT(refusal("a.csv", "\x89HDF\r\n\x1a\n"), HasSubstr("found an HDF5 file"));
  EXPECT_THAT(refusal("a.csv", archive), HasSubstr("found a ZIP archive"));
  EXPECT_EQ(format_of("a.bag", "t,q1,tau1\n0,0,0\n"), "CSV");
  EXPECT_EQ(format_of("a.csv", "PAR1,PAR2\n0,0\n"), "CSV");
  EXPECT_EQ(format_of("a.dat", "t\tq1\ttau1\r\n0\t0\t0\r\n"), "CSV");
  // One of MATLAB's is HDF5 inside.
  EXPECT_EQ(format_of("a.mat", "MATLAB 7.3 MAT-file"), "MATLAB .mat");
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
