#include "interface_restart.hpp"

#include <sys/ioctl.h>

#include <cstring>
#include <system_error>

namespace offnominal::hal {
namespace {

bool set_up(int socket, ifreq request, bool up) {
  if (::ioctl(socket, SIOCGIFFLAGS, &request) != 0) return false;
  const int flags = up ? request.ifr_flags | IFF_UP : request.ifr_flags & ~IFF_UP;
  request.ifr_flags = static_cast<short>(flags);
  return ::ioctl(socket, SIOCSIFFLAGS, &request) == 0;
}

}  // namespace

bool InterfaceRestart::start(int socket, const char* interface) {
  socket_ = socket;
  std::strncpy(request_.ifr_name, interface, IFNAMSIZ - 1);
  // Asking for the flags that it has changes nothing, and is refused to whom a change would be.
  ifreq unchanged = request_;
  if (::ioctl(socket_, SIOCGIFFLAGS, &unchanged) != 0) return false;
  if (::ioctl(socket_, SIOCSIFFLAGS, &unchanged) != 0) return false;
  try {
    thread_ = std::thread([this] { serve(); });
  } catch (const std::system_error&) {
    return false;
  }
  return true;
}

InterfaceRestart::~InterfaceRestart() {
  if (!thread_.joinable()) return;
  Phase asked = Phase::kAsked;
  while (busy()) phase_.wait(asked);
  phase_.store(Phase::kEnd);
  phase_.notify_all();
  thread_.join();
}

void InterfaceRestart::ask() {
  phase_.store(Phase::kAsked);
  phase_.notify_all();
}

void InterfaceRestart::serve() {
  for (;;) {
    phase_.wait(Phase::kIdle);
    if (phase_.load() == Phase::kEnd) return;
    // An interface that somebody else has taken down is his.
    ifreq flags = request_;
    if (::ioctl(socket_, SIOCGIFFLAGS, &flags) == 0 && (flags.ifr_flags & IFF_UP) != 0 &&
        set_up(socket_, request_, false)) {
      set_up(socket_, request_, true);
    }
    phase_.store(Phase::kIdle);
    phase_.notify_all();
  }
}

}  // namespace offnominal::hal
