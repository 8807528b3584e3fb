#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <offnominal/hal/bus/frame.hpp>
#include <offnominal/joint_count.hpp>
#include <offnominal/realtime/spsc_ring.hpp>
#include <string>
#include <thread>
#include <vector>

namespace offnominal::realtime {

using hal::Microseconds;

struct FrameEntry {
  hal::Frame frame;
  Microseconds time_us = 0;
};

// One line of the table: its time, then numbers, then one digit.
struct Row {
  // What a loop records: ten of every joint, and twelve more.
  static constexpr std::size_t kMostValues = 10 * static_cast<std::size_t>(kMaxJoints) + 12;
  Microseconds time_us = 0;
  std::array<double, kMostValues> values{};
  std::uint8_t digit = 0;  // 0 to 9
};

struct RecorderConfig {
  std::string candump{};     // file of every frame, as candump -l writes it; empty: none
  std::string interface {};  // its name in that file
  std::string csv{};         // file of every row; empty: none
  // Names of the numbers and of the digit, in that order; "t", the time in seconds, goes before
  // them. At most kMostValues + 1.
  std::vector<std::string> columns{};
  bool replace = false;  // files that exist
};

// Writes what a real-time thread hands over, from a thread of its own: keep() takes no lock, calls
// no system, uses no heap. Where the rings are full an entry is lost and counted.
//
// Whole lines go to the kernel 200 times a second: what the end of the process, even by SIGKILL,
// can cost is the last 5 ms, and of a line that was being written its end. A line is complete if a
// line feed ends it. A power failure may cost more.
class Recorder {
 public:
  Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;
  Recorder(Recorder&&) = delete;
  Recorder& operator=(Recorder&&) = delete;
  ~Recorder();

  // Makes the files and starts the thread. Otherwise returns an errno and sets failed_file().
  [[nodiscard]] int open(const RecorderConfig& config);
  // By the one thread that records.
  void keep(const FrameEntry& entry);
  void keep(const Row& row);
  // Writes what is left; nothing is kept afterwards.
  void close();

  // Entries that found no room, or that a file did not take.
  [[nodiscard]] std::uint64_t lost() const { return lost_.load(std::memory_order_relaxed); }
  // errno of the first write that failed, 0 while all is well; and its file.
  [[nodiscard]] int error_number() const { return error_.load(std::memory_order_acquire); }
  [[nodiscard]] const std::string& failed_file() const { return failed_file_; }

 private:
  class File;
  static constexpr std::size_t kFrames = 8192;
  static constexpr std::size_t kRows = 2048;

  void serve();
  void drain();

  RecorderConfig config_;
  std::unique_ptr<File> candump_;
  std::unique_ptr<File> csv_;
  std::unique_ptr<SpscRing<FrameEntry, kFrames>> frames_;
  std::unique_ptr<SpscRing<Row, kRows>> rows_;
  std::atomic<bool> ending_{false};
  std::atomic<std::uint64_t> lost_{0};
  std::atomic<int> error_{0};
  std::string failed_file_;
  std::thread thread_;
};

}  // namespace offnominal::realtime
