// The controller's program killed at any moment: the drives let go, and what it has recorded can be
// read.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <random>

#include "desk/sil/controller_on_vcan.hpp"
#include "log/candump_log.hpp"
#include "log/csv_log.hpp"
#include "sil/open_bus.hpp"
#include "support/seed.hpp"

namespace offnominal::desk::sil {
namespace {

using test::content_of;
using test::TemporaryFolder;

// Lines that are whole, that is, have an end.
std::size_t whole_lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

// Samples, of which there are as many as whole lines after the header.
std::size_t expect_readable_csv(const std::filesystem::path& file) {
  const std::size_t lines = whole_lines(content_of(file));
  if (lines < 2) return 0;
  const auto columns = read_csv(file, [](const std::string&) { return Need::kRequired; }).columns;
  const Eigen::VectorXd& t_s = columns.at("t");
  const auto rows = static_cast<std::size_t>(t_s.size());
  // One more where the last one lacks nothing but its end.
  EXPECT_TRUE(rows == lines - 1 || rows == lines) << rows << " rows, " << lines << " lines";
  for (Eigen::Index i = 1; i < t_s.size(); ++i) EXPECT_GT(t_s[i], t_s[i - 1]);
  return rows;
}

std::size_t expect_readable_candump(const std::filesystem::path& file) {
  const std::string text = content_of(file);
  std::size_t frames = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    if (end == std::string::npos) break;
    EXPECT_TRUE(parse_candump_line(std::string_view(text).substr(begin, end - begin)).has_value());
    ++frames;
    begin = end + 1;
  }
  return frames;
}

struct Recorded {
  std::size_t rows = 0;
  std::size_t frames = 0;
};

Recorded kill_once(std::mt19937_64& random) {
  const TemporaryFolder folder;
  hal::SocketCan socket;
  open_bus("vcan0", {.may_restart_interface = false}, socket);
  Arm<hal::SocketCan> arm(socket);
  ControllerProcess controller(
      {"--candump", folder / "run.log", "--log", folder / "run.csv", "--end-at-fault"});
  EXPECT_TRUE(arm.tick_until([&] { return arm.gives_torque() || controller.has_ended(); }));
  arm.ticks(std::uniform_int_distribution<int>(0, 80)(random));
  EXPECT_TRUE(arm.gives_torque()) << controller.said();
  // Between two ticks as well as in the middle of one.
  ::usleep(std::uniform_int_distribution<unsigned>(0, kTickUs)(random));
  controller.signal(SIGKILL);
  EXPECT_TRUE(WIFSIGNALED(controller.wait())) << "it ended before it was killed";
  // The watch-dogs' five periods, and what was on its way.
  arm.ticks(8);
  EXPECT_FALSE(arm.gives_torque());
  return {expect_readable_csv(folder / "run.csv"), expect_readable_candump(folder / "run.log")};
}

// GIVEN an arm under torque WHEN the controller is killed at a random moment THEN every drive has
// let go a few ticks later, and its recordings are readable up to their last whole line. Eight
// times, or OFFNOMINAL_KILLS times.
TEST(KilledController, LeavesDrivesThatLetGoAndRecordingsThatCanBeRead) {
  std::mt19937_64 random = test::seeded_generator();
  const char* wished = std::getenv("OFFNOMINAL_KILLS");
  const int times = wished != nullptr ? std::max(1, std::atoi(wished)) : 8;
  Recorded sum;
  for (int killed = 0; killed < times; ++killed) {
    const Recorded recorded = kill_once(random);
    sum.rows += recorded.rows;
    sum.frames += recorded.frames;
  }
  std::cout << "killed " << times << " times; " << sum.rows << " samples and " << sum.frames
            << " frames recorded\n";
  EXPECT_GT(sum.rows, 10U * static_cast<unsigned>(times));
  EXPECT_GT(sum.frames, 60U * static_cast<unsigned>(times));
}

}  // namespace
}  // namespace offnominal::desk::sil
