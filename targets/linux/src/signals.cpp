#include <pthread.h>

#include <ctime>
#include <offnominal/realtime/signals.hpp>

namespace offnominal::realtime {

Signals::Signals() {
  ::sigemptyset(&watched_);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGTSTP, SIGUSR1, SIGUSR2}) {
    ::sigaddset(&watched_, signal);
  }
  ::pthread_sigmask(SIG_BLOCK, &watched_, &before_);
}

Signals::~Signals() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

int Signals::wait(std::chrono::milliseconds patience) const {
  const timespec time{.tv_sec = static_cast<time_t>(patience.count() / 1000),
                      .tv_nsec = static_cast<long>(patience.count() % 1000 * 1'000'000)};
  const int signal = ::sigtimedwait(&watched_, nullptr, &time);
  return signal > 0 ? signal : 0;
}

}  // namespace offnominal::realtime
