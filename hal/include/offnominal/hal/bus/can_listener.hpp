#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <offnominal/hal/bus/frame.hpp>
#include <offnominal/hal/status.hpp>
#include <span>

namespace offnominal::hal {

// A CAN interface of the Linux kernel for who only listens: no function of this class, nor of the
// source behind it, writes to the socket or changes the interface (a gate looks at its object).
// What it does not keep from the bus is the controller's own acknowledgement of frames, which the
// interface gives for all of its sockets: `ip link set can0 type can listen-only on` does.
class CanListener {
 public:
  CanListener();
  CanListener(const CanListener&) = delete;
  CanListener& operator=(const CanListener&) = delete;
  CanListener(CanListener&&) = delete;
  CanListener& operator=(CanListener&&) = delete;
  ~CanListener();

  // Once, before anything else. kNoSuchInterface, kNotPermitted, kSystemError: error_number() is
  // the system's errno. An interface that is down is no error.
  [[nodiscard]] Status open(const char* interface);
  [[nodiscard]] int error_number() const { return error_number_; }

  // CLOCK_MONOTONIC; `time_us` of a frame is the kernel's time stamp on that scale.
  [[nodiscard]] Microseconds now() const;
  // Frames of all senders, oldest first, at most into.size(). Where there are none it waits for
  // them, at most so long.
  [[nodiscard]] std::size_t receive(std::span<ReceivedFrame> into, Microseconds patience_us);
  // As of the last receive().
  [[nodiscard]] bool is_up() const;
  // Frames that the kernel had no room for, since open().
  [[nodiscard]] std::uint32_t overflow() const;

 private:
  class Port;
  std::unique_ptr<Port> port_;
  int error_number_ = 0;
};

}  // namespace offnominal::hal
