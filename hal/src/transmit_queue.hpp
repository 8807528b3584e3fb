#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <offnominal/hal/bus/frame.hpp>
#include <offnominal/hal/bus/socketcan.hpp>

namespace offnominal::hal {

// Which frames wait here and which are in the hands of the kernel, each with its deadline. Nothing
// but book-keeping: no call of the system.
class TransmitQueue {
 public:
  static constexpr std::size_t kMailboxes = 64;
  struct Mailbox {
    bool full = false;
    Frame frame;
    Microseconds deadline_us = 0;
  };
  enum class Placed : std::uint8_t { kNew, kInPlaceOfOld, kNoRoom };

  explicit TransmitQueue(std::size_t in_kernel) : window_(in_kernel) {}

  [[nodiscard]] Placed place(const Frame& frame, Microseconds deadline_us);
  [[nodiscard]] bool waits() const { return waiting_ > 0; }

  // The frame that the kernel may be given next, the lowest identifier first; null where none waits
  // or the kernel has its share.
  [[nodiscard]] Mailbox* next();
  // The kernel has taken that frame.
  void taken(Mailbox& mailbox);

  // A frame with these identifier bits has gone out, at that time; whether that was too late.
  [[nodiscard]] bool gone_out(const Frame& frame, Microseconds time_us);

  // Frames that wait here beyond their deadline are forgotten; returns how many.
  std::uint32_t forget_late(Microseconds now_us);
  // How many frames have passed their deadline in the kernel since the last call.
  std::uint32_t newly_late_in_kernel(Microseconds now_us);

  // Forgets what waits here, or what the kernel has; returns how many that had not been late yet.
  std::uint32_t forget_waiting();
  std::uint32_t forget_in_kernel();
  [[nodiscard]] bool kernel_has_any() const { return in_kernel_ > 0; }

 private:
  struct InKernel {
    std::uint32_t id = 0;
    bool extended = false;
    bool late = false;
    Microseconds deadline_us = 0;
  };
  [[nodiscard]] bool kernel_has(const Frame& frame) const;

  std::size_t window_;
  std::array<Mailbox, kMailboxes> mailboxes_{};
  std::size_t waiting_ = 0;
  std::array<InKernel, SocketCanConfig::kMostInKernel> kernel_{};
  std::size_t in_kernel_ = 0;
};

}  // namespace offnominal::hal
