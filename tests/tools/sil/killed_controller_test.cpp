// The controller's program killed at any moment: the drives let go, and what it has recorded can be
// read.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <offnominal/realtime/cycle_timer.hpp>
#include <optional>
#include <random>
#include <stdexcept>
#include <vector>

#include "log/candump_log.hpp"
#include "log/csv_log.hpp"
#include "offnominal/sim/bus/plant_node.hpp"
#include "offnominal/sim/uncertainty.hpp"
#include "sil/open_bus.hpp"
#include "sil/plant_of.hpp"
#include "support/seed.hpp"
#include "tools/support/temporary_folder.hpp"

namespace offnominal::tools::sil {
namespace {

using test::content_of;
using test::TemporaryFolder;

// Slow enough for a machine that is ten times slower than its host and shares that with others.
constexpr double kPeriod = 0.01;
constexpr hal::Microseconds kPeriodUs = 10'000;

pid_t start_controller(const TemporaryFolder& folder) {
  std::vector<std::string> words = {OFFNOMINAL_CONTROLLER,
                                    "--bus",
                                    "vcan0",
                                    "--rate",
                                    "100",
                                    "--arm",
                                    "--motion",
                                    "paper",
                                    "--candump",
                                    folder / "run.log",
                                    "--log",
                                    folder / "run.csv",
                                    "--end-at-fault",
                                    "--no-lock",
                                    "--priority",
                                    "0",
                                    "--json"};
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int error = ::posix_spawn(&child, argv[0], &actions, nullptr, argv.data(), ::environ);
  posix_spawn_file_actions_destroy(&actions);
  return error == 0 ? child : 0;
}

// The arm at its end of vcan0, tick by tick in real time.
class Arm {
 public:
  Arm() : plant_(plant_of({}, kPeriod)), port_(socket_) {
    open_bus("vcan0", {.may_restart_interface = false}, socket_);
  }
  void tick() {
    const realtime::Tick begun = timer_.wait();
    plant_.tick(begun.begin_us + timer_.period_us(), port_);
  }
  // Until it moves, or the controller has ended, or ten seconds have passed.
  void wait_for_start(pid_t controller) {
    siginfo_t ended{};
    for (int i = 0; i < 2000 && !plant_.started() && ended.si_pid == 0; ++i) {
      tick();
      ::waitid(P_PID, static_cast<id_t>(controller), &ended, WEXITED | WNOHANG | WNOWAIT);
    }
  }
  [[nodiscard]] bool started() const { return plant_.started(); }
  [[nodiscard]] bool gives_torque() const {
    return plant_.drives().mode(0) == hal::DriveMode::kTorque ||
           plant_.drives().mode(1) == hal::DriveMode::kTorque;
  }

 private:
  hal::SocketCan socket_;
  sim::PlantNode plant_;
  BusPortOf<hal::SocketCan&> port_;
  realtime::CycleTimer timer_{kPeriodUs, kPeriodUs / 2};
};

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

// None where the controller had ended by itself before, for frames that came too late: then nothing
// was killed.
std::optional<Recorded> kill_once(std::mt19937_64& random) {
  const TemporaryFolder folder;
  Arm arm;
  const pid_t controller = start_controller(folder);
  if (controller == 0) throw std::runtime_error(OFFNOMINAL_CONTROLLER);
  arm.wait_for_start(controller);
  for (int more = std::uniform_int_distribution<int>(0, 8)(random); more > 0; --more) arm.tick();
  // Between two ticks as well as in the middle of one.
  ::usleep(std::uniform_int_distribution<unsigned>(0, kPeriodUs)(random));
  ::kill(controller, SIGKILL);
  int status = 0;
  if (::waitpid(controller, &status, 0) != controller) throw std::runtime_error("waitpid");
  if (!WIFSIGNALED(status) || !arm.started()) return std::nullopt;
  // The watch-dogs' five periods, and what was on its way.
  for (int tick = 0; tick < 8; ++tick) arm.tick();
  EXPECT_FALSE(arm.gives_torque());
  return Recorded{expect_readable_csv(folder / "run.csv"),
                  expect_readable_candump(folder / "run.log")};
}

// GIVEN an arm under torque WHEN the controller is killed at a random moment THEN every drive has
// let go a few ticks later, and its recordings are readable up to their last whole line. Eight
// times, or OFFNOMINAL_KILLS times.
TEST(KilledController, LeavesDrivesThatLetGoAndRecordingsThatCanBeRead) {
  std::mt19937_64 random = test::seeded_generator();
  const char* wished = std::getenv("OFFNOMINAL_KILLS");
  const int times = wished != nullptr ? std::max(1, std::atoi(wished)) : 8;
  int killed = 0;
  int tried = 0;
  Recorded sum;
  for (; killed < times && tried < 3 * times; ++tried) {
    const auto recorded = kill_once(random);
    if (!recorded) continue;
    ++killed;
    sum.rows += recorded->rows;
    sum.frames += recorded->frames;
  }
  std::cout << "killed " << killed << " times, of " << tried << " starts; " << sum.rows
            << " samples and " << sum.frames << " frames recorded\n";
  EXPECT_EQ(killed, times);
  EXPECT_GT(sum.rows, static_cast<unsigned>(times));
  EXPECT_GT(sum.frames, 10U * static_cast<unsigned>(times));
}

}  // namespace
}  // namespace offnominal::tools::sil
