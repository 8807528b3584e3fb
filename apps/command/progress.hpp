#pragma once

#include <unistd.h>

#include <chrono>
#include <iostream>
#include <string>

namespace offnominal::desk {

/// Says on stderr what is going on, once it has taken over two seconds and where stderr is a
/// terminal; at most four times a second. end() wipes its line, before anything else is printed.
class Progress {
 public:
  Progress() = default;
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress() { end(); }

  /// What is being done now; step() and reach() count from 0 again.
  void begin(std::string what) {
    what_ = std::move(what);
    steps_ = 0;
    percent_ = -1;
    show();
  }

  void step() {
    ++steps_;
    show();
  }

  /// How far it has come, 0 to 1.
  void reach(double share) {
    percent_ = static_cast<int>(100 * share);
    show();
  }

  void end() {
    if (shown_) std::cerr << "\r\033[K" << std::flush;
    shown_ = false;
  }

 private:
  void show() {
    if (!terminal_) return;
    const auto now = std::chrono::steady_clock::now();
    if (now - start_ < std::chrono::seconds(2)) return;
    if (shown_ && now - last_ < std::chrono::milliseconds(250)) return;
    last_ = now;
    shown_ = true;
    std::cerr << "\r\033[K" << what_;
    if (steps_ > 0) std::cerr << ": " << steps_ << " tried";
    if (percent_ >= 0) std::cerr << ": " << percent_ << " %";
    std::cerr << std::flush;
  }

  std::string what_;
  long steps_ = 0;
  int percent_ = -1;  // none
  bool terminal_ = ::isatty(STDERR_FILENO) != 0;
  bool shown_ = false;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point last_ = start_;
};

}  // namespace offnominal::desk
