#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <offnominal/hal/bus/bus.hpp>
#include <offnominal/hal/bus/frame.hpp>
#include <offnominal/hal/status.hpp>
#include <span>

namespace offnominal::hal {

struct SocketCanConfig {
  static constexpr std::size_t kMostInKernel = 16;

  const char* interface = "";  // "can0", "vcan0"; need not outlive open()
  // What receive() hands over, sifted by the kernel; empty: everything. Then send() takes
  // everything too, otherwise what `transmit` lets pass: the kernel's word that a frame has gone
  // out comes through the same sieve. Together at most 64.
  std::span<const IdFilter> receive{};
  std::span<const IdFilter> transmit{};
  // Frames of different identifiers that may be in the hands of the kernel and the controller at
  // once, 1 to kMostInKernel. All others wait here, where a deadline costs nothing.
  std::size_t in_kernel = 8;
  // May a frame that the kernel holds beyond its deadline be taken back? There is one way: the
  // interface goes down and up again, for everybody on it, and the process needs CAP_NET_ADMIN.
  bool may_restart_interface = true;
  // Nothing is sent for so long after such a restart. A bus that is still blocked is tried no more
  // often.
  Microseconds pause_after_restart_us = 100'000;
};

// A CAN interface of the Linux kernel (PF_CAN, raw socket) as a Bus. Classic CAN, and CAN FD where
// the interface has it.
//
// now() is CLOCK_MONOTONIC; `time_us` of a frame is the kernel's time stamp on that scale.
//
// A frame counts as `sent` when the driver says that it has gone out. Until then it is in the hands
// of the kernel, of which there is at most one per identifier and `in_kernel` in all; the next of
// the same identifier waits here, in its place the one after. What the kernel still holds at its
// deadline is found by receive() and counted `late`. Where that is allowed and permitted the
// interface is then restarted by a thread of its own: nothing of what was taken before goes out any
// more, and the mode is kDown for that time and the pause. The frame on the wire may complete
// meanwhile, in the milliseconds that the kernel needs. Where it is not, nothing can be taken back:
// at most `in_kernel` old frames go out when the bus is free again (sent_late() counts them), and
// none waits behind them for longer than its deadline.
//
// drop_pending() works alike, without the pause: on a healthy bus the kernel holds nothing then.
//
// Bus-off: where the interface may be restarted it is, since the kernel keeps its queue for about a
// second after bus-off and would send it after a quicker recovery; kOff ends with the pause. Where
// it may not, kOff ends when the driver reports a restart (`restart-ms` of the interface, or `ip
// link set can0 type can restart`), and in_kernel = 1 is what keeps that queue empty. kDown ends
// when the interface is up again. An interface that was removed stays kDown: open() again.
//
// The heap is used in open() alone.
class SocketCan {
 public:
  SocketCan();
  SocketCan(const SocketCan&) = delete;
  SocketCan& operator=(const SocketCan&) = delete;
  SocketCan(SocketCan&&) = delete;
  SocketCan& operator=(SocketCan&&) = delete;
  ~SocketCan();

  // Once, before anything else; until then, and after a failure, the bus is kDown.
  // kNoSuchInterface, kNotPermitted, kSystemError: error_number() is the system's errno. An
  // interface that is down is no error.
  [[nodiscard]] Status open(const SocketCanConfig& config);
  [[nodiscard]] int error_number() const { return error_number_; }

  [[nodiscard]] Microseconds now() const;
  [[nodiscard]] Status send(const Frame& frame, Microseconds deadline_us);
  [[nodiscard]] std::size_t receive(std::span<ReceivedFrame> into);
  void drop_pending();
  [[nodiscard]] BusState state() const;

  // Whether late frames can be taken back from the kernel.
  [[nodiscard]] bool can_take_back() const;
  // Of those `sent`, the ones that had passed their deadline in the kernel.
  [[nodiscard]] std::uint32_t sent_late() const;

 private:
  class Port;
  std::unique_ptr<Port> port_;
  int error_number_ = 0;
};

static_assert(Bus<SocketCan>);

}  // namespace offnominal::hal
