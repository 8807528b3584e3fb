#include <gtest/gtest.h>
#include <pthread.h>

#include <chrono>
#include <csignal>
#include <offnominal/realtime/signals.hpp>

namespace offnominal::realtime {
namespace {

// What would end or stop the process, and leave an arm with its last torque, is an event, Ctrl-Z
// too.
TEST(Signals, ThatEndOrStopAreEvents) {
  const Signals signals;
  sigset_t blocked;
  ASSERT_EQ(::pthread_sigmask(SIG_SETMASK, nullptr, &blocked), 0);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGTSTP, SIGUSR1, SIGUSR2}) {
    ASSERT_EQ(::sigismember(&blocked, signal), 1) << signal;
    ASSERT_EQ(::pthread_kill(::pthread_self(), signal), 0);
    EXPECT_EQ(signals.wait(std::chrono::milliseconds(1000)), signal);
  }
  EXPECT_EQ(signals.wait(std::chrono::milliseconds(0)), 0);
}

}  // namespace
}  // namespace offnominal::realtime
