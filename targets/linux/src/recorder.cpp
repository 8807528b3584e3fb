#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <offnominal/realtime/recorder.hpp>
#include <system_error>

#include "line_text.hpp"

namespace offnominal::realtime {
namespace {

constexpr std::chrono::milliseconds kPause{5};

std::string header_of(const std::vector<std::string>& columns) {
  std::string line = "t";
  for (const std::string& column : columns) line += "," + column;
  return line + "\n";
}

}  // namespace

// Takes lines and writes them by the buffer; after a failure it takes them and writes nothing.
class Recorder::File {
 public:
  File() = default;
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  File(File&&) = delete;
  File& operator=(File&&) = delete;
  ~File() {
    if (file_ >= 0) ::close(file_);
  }

  [[nodiscard]] int open(const std::string& path, bool replace) {
    const int if_there = replace ? O_TRUNC : O_EXCL;
    file_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | if_there, 0666);
    return file_ >= 0 ? 0 : errno;
  }
  void add(std::span<const char> line) {
    if (size_ + line.size() > buffer_.size()) flush();
    std::copy(line.begin(), line.end(), buffer_.begin() + static_cast<std::ptrdiff_t>(size_));
    size_ += line.size();
  }
  void flush() {
    const char* from = buffer_.data();
    while (size_ > 0 && error_ == 0) {
      const ssize_t written = ::write(file_, from, size_);
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) {
        error_ = written < 0 ? errno : EIO;
        break;
      }
      from += written;
      size_ -= static_cast<std::size_t>(written);
    }
    size_ = 0;
  }
  [[nodiscard]] int error() const { return error_; }

 private:
  int file_ = -1;
  int error_ = 0;
  std::size_t size_ = 0;
  std::array<char, 16 * kLongestLine> buffer_{};
};

Recorder::Recorder() = default;

Recorder::~Recorder() { close(); }

int Recorder::open(const RecorderConfig& config) {
  config_ = config;
  const auto make = [&](const std::string& path, std::unique_ptr<File>& file) {
    if (path.empty()) return 0;
    file = std::make_unique<File>();
    const int error = file->open(path, config.replace);
    if (error != 0) failed_file_ = path;
    return error;
  };
  if (const int error = make(config.candump, candump_); error != 0) return error;
  if (const int error = make(config.csv, csv_); error != 0) return error;
  if (candump_) frames_ = std::make_unique<SpscRing<FrameEntry, kFrames>>();
  if (csv_) {
    rows_ = std::make_unique<SpscRing<Row, kRows>>();
    csv_->add(header_of(config.columns));
  }
  if (!candump_ && !csv_) return 0;
  try {
    thread_ = std::thread([this] { serve(); });
  } catch (const std::system_error& error) {
    return error.code().value();
  }
  return 0;
}

void Recorder::keep(const FrameEntry& entry) {
  if (frames_ && !frames_->push(entry)) lost_.fetch_add(1, std::memory_order_relaxed);
}

void Recorder::keep(const Row& row) {
  if (rows_ && !rows_->push(row)) lost_.fetch_add(1, std::memory_order_relaxed);
}

void Recorder::close() {
  if (!thread_.joinable()) return;
  ending_.store(true, std::memory_order_release);
  thread_.join();
}

void Recorder::serve() {
  for (;;) {
    // Looked at before the rings: what was kept before the end was asked for is still written.
    const bool last = ending_.load(std::memory_order_acquire);
    drain();
    if (last) return;
    std::this_thread::sleep_for(kPause);
  }
}

void Recorder::drain() {
  std::array<char, kLongestLine> line;
  const auto add = [&](File& file, std::size_t size) {
    file.add(std::span(line).first(size));
    if (file.error() != 0) lost_.fetch_add(1, std::memory_order_relaxed);
  };
  FrameEntry frame;
  while (frames_ && frames_->pop(frame)) {
    add(*candump_, candump_text(frame, config_.interface.c_str(), line));
  }
  Row row;
  while (rows_ && rows_->pop(row)) add(*csv_, row_text(row, config_.columns.size() - 1, line));
  for (const auto& [file, path] :
       {std::pair(candump_.get(), &config_.candump), std::pair(csv_.get(), &config_.csv)}) {
    if (file == nullptr) continue;
    file->flush();
    if (file->error() == 0 || error_.load(std::memory_order_relaxed) != 0) continue;
    failed_file_ = *path;
    error_.store(file->error(), std::memory_order_release);
  }
}

}  // namespace offnominal::realtime
