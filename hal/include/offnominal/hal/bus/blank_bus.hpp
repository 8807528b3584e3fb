#pragma once

#include <cstddef>
#include <offnominal/hal/bus/bus.hpp>
#include <offnominal/hal/bus/frame.hpp>
#include <offnominal/hal/status.hpp>
#include <span>

namespace offnominal::hal {

// A bus without a wire: the pattern for the CAN controller of a new chip. Copy it, give it the
// chip's registers, and write what each function's text asks for. As it stands it is a node whose
// interface is down: it refuses to send and never receives, so a controller that is built on it
// stays in kInit and commands nothing.
class BlankBus {
 public:
  // Free-running microseconds, from a timer that is extended to 64 bits: in an interrupt at its
  // overflow, or here, where it is certain that every half of its period this function is called.
  [[nodiscard]] Microseconds now() { return 0; }

  // Put the frame into a transmit buffer of its own identifier: bxCAN has 3 mailboxes, FDCAN a
  // queue of elements with a mask of pending ones. If that buffer is still pending, ask for its
  // abortion first (ABRQ, TXBCR), wait for the request's end at most some microseconds, and count
  // `dropped`. Keep deadline_us beside the buffer.
  [[nodiscard]] Status send(const Frame& frame, Microseconds deadline_us) {
    static_cast<void>(deadline_us);
    return is_well_formed(frame) ? Status::kInterfaceDown : Status::kFrameNotSupported;
  }

  // 1. Abort every transmit buffer whose deadline has passed; count `late`.
  // 2. Read the error state (ESR, PSR) into state().mode. In bus-off call drop_pending() first, and
  //    only then let the controller recover.
  // 3. Empty the receive FIFO into `into`; check the length's code before any data is copied.
  [[nodiscard]] std::size_t receive(std::span<ReceivedFrame> into) {
    static_cast<void>(into);
    return 0;
  }

  // Abort every transmit buffer, and return only when none is pending.
  void drop_pending() {}

  [[nodiscard]] BusState state() const { return {.mode = BusMode::kDown}; }
};

static_assert(Bus<BlankBus>);

}  // namespace offnominal::hal
