#pragma once

#include <net/if.h>

#include <atomic>
#include <cstdint>
#include <thread>

namespace offnominal::hal {

// Takes a network interface down and up again, on a thread of its own: that waits for the kernel,
// for milliseconds. Down, the kernel empties its queue and the controller its transmit buffers.
class InterfaceRestart {
 public:
  InterfaceRestart() = default;
  InterfaceRestart(const InterfaceRestart&) = delete;
  InterfaceRestart& operator=(const InterfaceRestart&) = delete;
  InterfaceRestart(InterfaceRestart&&) = delete;
  InterfaceRestart& operator=(InterfaceRestart&&) = delete;
  ~InterfaceRestart();

  // `socket` has to outlive the object. False where the process may not do it, or has no thread
  // left.
  [[nodiscard]] bool start(int socket, const char* interface);

  // Does not wait. Only when not busy.
  void ask();
  [[nodiscard]] bool busy() const { return phase_.load() == Phase::kAsked; }

 private:
  enum class Phase : std::uint8_t { kIdle, kAsked, kEnd };
  void serve();

  int socket_ = -1;
  ifreq request_{};
  std::atomic<Phase> phase_{Phase::kIdle};
  std::thread thread_;
};

}  // namespace offnominal::hal
