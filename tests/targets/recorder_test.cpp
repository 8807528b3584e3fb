#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <offnominal/realtime/recorder.hpp>

#include "desk/support/temporary_folder.hpp"
#include "log/candump_text.hpp"
#include "log/csv_log.hpp"

namespace offnominal::realtime {
namespace {

hal::Frame frame_of(std::uint32_t id, std::uint8_t length, bool fd = false) {
  hal::Frame frame;
  frame.id = id;
  frame.length = length;
  frame.fd = fd;
  for (std::size_t i = 0; i < length; ++i) frame.data[i] = static_cast<std::uint8_t>(37 * i + 5);
  return frame;
}

TEST(Recorder, WritesFramesAsTheDesksWriterDoes) {
  const test::TemporaryFolder folder;
  std::string expected;
  std::vector<hal::Frame> frames = {frame_of(0x181, 8), frame_of(0x001, 0),
                                    frame_of(0x1A0, 64, true), frame_of(0x7FF, 3)};
  frames[1].extended = true;
  frames[3].remote = true;
  {
    Recorder recorder;
    ASSERT_EQ(recorder.open({.candump = folder / "run.log", .interface = "can1"}), 0);
    Microseconds time_us = 999'999;
    for (const hal::Frame& frame : frames) {
      recorder.keep(FrameEntry{frame, time_us});
      expected += desk::candump_line(frame, time_us, "can1");
      time_us += 1'000'006;
    }
    recorder.close();
    EXPECT_EQ(recorder.lost(), 0U);
  }
  EXPECT_EQ(test::content_of(folder / "run.log"), expected);
}

TEST(Recorder, WritesRowsThatReadBackAsTheSameNumbers) {
  const test::TemporaryFolder folder;
  Recorder recorder;
  ASSERT_EQ(recorder.open({.csv = folder / "run.csv", .columns = {"a", "b", "state"}}), 0);
  const std::vector<double> values = {0.1, -1e-300, 1.0 / 3, 123456789.125, 0};
  for (std::size_t i = 0; i < values.size(); ++i) {
    Row row;
    row.time_us = 1'000'000'001 + 1000 * static_cast<Microseconds>(i);
    row.values[0] = values[i];
    row.values[1] = -values[i];
    row.digit = static_cast<std::uint8_t>(i);
    recorder.keep(row);
  }
  recorder.close();
  const auto columns = desk::read_csv(folder / "run.csv", [](const std::string&) {
                         return desk::Need::kRequired;
                       }).columns;
  ASSERT_EQ(columns.at("t").size(), static_cast<Eigen::Index>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    EXPECT_EQ(columns.at("a")[row], values[i]);
    EXPECT_EQ(columns.at("b")[row], -values[i]);
    EXPECT_EQ(columns.at("state")[row], static_cast<double>(i));
    EXPECT_NEAR(columns.at("t")[row], 1000.000001 + 0.001 * static_cast<double>(i), 1e-9);
  }
}

TEST(Recorder, ReplacesAFileOnlyWhereThatIsAllowed) {
  const test::TemporaryFolder folder;
  test::put(folder / "run.csv", "somebody's work");
  Recorder refused;
  EXPECT_EQ(refused.open({.csv = folder / "run.csv", .columns = {"state"}}), EEXIST);
  EXPECT_EQ(refused.failed_file(), (folder / "run.csv").string());
  EXPECT_EQ(test::content_of(folder / "run.csv"), "somebody's work");
  Recorder allowed;
  ASSERT_EQ(allowed.open({.csv = folder / "run.csv", .columns = {"state"}, .replace = true}), 0);
  allowed.close();
  EXPECT_EQ(test::content_of(folder / "run.csv"), "t,state\n");
}

// GIVEN a file that takes nothing WHEN rows are kept THEN that is counted and named, and nobody
// waits.
TEST(Recorder, SaysWhereADiskIsFull) {
  Recorder recorder;
  ASSERT_EQ(recorder.open({.csv = "/dev/full", .columns = {"state"}, .replace = true}), 0);
  for (int i = 0; i < 5000; ++i) recorder.keep(Row{});
  recorder.close();
  EXPECT_EQ(recorder.error_number(), ENOSPC);
  EXPECT_EQ(recorder.failed_file(), "/dev/full");
  EXPECT_GT(recorder.lost(), 0U);
}

}  // namespace
}  // namespace offnominal::realtime
