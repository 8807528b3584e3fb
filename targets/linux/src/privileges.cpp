#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <offnominal/realtime/privileges.hpp>

namespace offnominal::realtime {
namespace {

// The pages of the stack that a cycle will use are there afterwards.
[[gnu::noinline]] void touch_stack() {
  std::array<volatile char, Wish::kStackBytes> room;
  constexpr std::size_t kPage = 4096;
  for (std::size_t i = 0; i < room.size(); i += kPage) room[i] = 0;
}

std::string refused(const char* what, int error, const char* mend) {
  return std::string(what) + " refused (" + std::strerror(error) + "; " + mend + ")";
}

}  // namespace

Grant ask_for(const Wish& wish) {
  Grant grant;
  if (wish.lock_memory) {
    grant.locked = ::mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
    grant.lock_error = grant.locked ? 0 : errno;
  }
  touch_stack();
  if (wish.priority > 0) {
    sched_param parameters{};
    parameters.sched_priority = wish.priority;
    grant.fifo_error = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters);
    grant.fifo = grant.fifo_error == 0;
    if (grant.fifo) grant.priority = wish.priority;
  }
  return grant;
}

std::string words_of(const Grant& grant) {
  std::string words = "ordinary scheduling";
  if (grant.fifo) {
    words = "SCHED_FIFO " + std::to_string(grant.priority);
  } else if (grant.fifo_error != 0) {
    words = refused("SCHED_FIFO", grant.fifo_error, "CAP_SYS_NICE or `ulimit -r` allows it");
  }
  if (grant.locked) {
    words += ", memory locked";
  } else if (grant.lock_error != 0) {
    words += ", " + refused("locking memory", grant.lock_error,
                            "CAP_IPC_LOCK or `ulimit -l unlimited` allows it");
  }
  return words + ", " + std::to_string(Wish::kStackBytes / 1024) + " KiB of stack touched";
}

}  // namespace offnominal::realtime
