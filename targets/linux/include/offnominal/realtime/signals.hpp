#pragma once

#include <chrono>
#include <csignal>

namespace offnominal::realtime {

// SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGTSTP, SIGUSR1 and SIGUSR2 as events of one thread.
// To be made before any other thread is: those inherit that they are not interrupted.
class Signals {
 public:
  Signals();
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;
  Signals(Signals&&) = delete;
  Signals& operator=(Signals&&) = delete;
  ~Signals();

  // The next one, waited for no longer than said; 0 where none came.
  [[nodiscard]] int wait(std::chrono::milliseconds patience) const;

 private:
  sigset_t watched_{};
  sigset_t before_{};
};

}  // namespace offnominal::realtime
