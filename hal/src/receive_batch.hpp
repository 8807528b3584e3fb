#pragma once

#include <linux/can.h>
#include <sys/socket.h>
#include <sys/uio.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <offnominal/hal/bus/frame.hpp>

namespace offnominal::hal {

// One frame as the socket gave it.
struct RawArrival {
  const canfd_frame* raw = nullptr;
  std::size_t size = 0;
  bool own = false;          // this socket's own frame, that has gone out
  Microseconds time_us = 0;  // CLOCK_MONOTONIC
};

// Fetches frames from a raw socket, many with one call of the system.
class ReceiveBatch {
 public:
  static constexpr std::size_t kMost = 32;

  ReceiveBatch();

  // At most `most` frames; 0 where there are none. `error`: errno of what went wrong, 0 otherwise.
  [[nodiscard]] std::size_t fetch(int socket, std::size_t most, int& error);
  // Of those that fetch() gave last.
  [[nodiscard]] RawArrival arrival(std::size_t index) const;
  // Frames that the kernel had no room for, since the socket is open.
  [[nodiscard]] std::uint32_t lost() const { return lost_; }

 private:
  struct Control {
    alignas(cmsghdr) std::array<unsigned char, CMSG_SPACE(sizeof(timespec)) +
                                                   CMSG_SPACE(sizeof(std::uint32_t))> bytes;
  };
  std::array<canfd_frame, kMost> frames_{};
  std::array<iovec, kMost> parts_{};
  std::array<Control, kMost> controls_{};
  std::array<mmsghdr, kMost> messages_{};
  std::array<Microseconds, kMost> times_us_{};
  Microseconds last_empty_us_ = 0;
  std::uint32_t lost_ = 0;
};

}  // namespace offnominal::hal
