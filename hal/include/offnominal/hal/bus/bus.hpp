#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <offnominal/hal/bus/frame.hpp>
#include <offnominal/hal/status.hpp>
#include <span>

namespace offnominal::hal {

// What a CAN controller says of itself (ISO 11898-1, fault confinement).
enum class BusMode : std::uint8_t {
  kActive = 0,   // error active: takes part fully
  kWarning = 1,  // an error counter has reached 96
  kPassive = 2,  // an error counter has reached 128
  kOff = 3,      // does not take part; recovers only as the backend's text says
  kDown = 4,     // no interface: unplugged, not configured
};

// Counters since the start; they wrap.
struct BusState {
  BusMode mode = BusMode::kActive;
  std::uint32_t sent = 0;              // frames that are known to have gone out
  std::uint32_t received = 0;          // frames handed over by receive()
  std::uint32_t late = 0;              // frames not sent because their deadline had passed
  std::uint32_t dropped = 0;           // frames not sent because of drop_pending() or bus-off
  std::uint32_t receive_overflow = 0;  // frames lost before receive() fetched them
  std::uint32_t errors = 0;            // error frames, of whichever node
};

// All that offnominal asks of a CAN bus. Nothing blocks, allocates or throws, and one thread at a
// time uses an object.
//
// now()           Monotonic time, us. Time stamps of received frames and deadlines are on its
// scale. send(f, t)      Takes the frame for transmission. It goes out at once or waits, at most
// until
//                 now() = t: then it is dropped, wherever it waits, and never goes out. At most one
//                 frame per identifier waits; a new one takes the place of the old. kOk: taken.
//                 kDeadlinePassed, kQueueFull, kFrameNotSupported, kBusOff, kInterfaceDown: not
//                 taken. Taken does not mean received: the counters say what has gone out.
// receive(into)   Fetches what has arrived, oldest first, at most into.size(); returns how many. It
//                 also does what is due: deadlines, the controller's events. Call it every tick.
// drop_pending()  Nothing that was taken before goes out any more: after an emergency stop, at the
//                 entry into a safe state.
// state()         Mode and counters.
template <typename B>
concept Bus = requires(B& bus, const B& seen, const Frame& frame, Microseconds deadline_us,
                       std::span<ReceivedFrame> into) {
  { bus.now() } -> std::same_as<Microseconds>;
  { bus.send(frame, deadline_us) } -> std::same_as<Status>;
  { bus.receive(into) } -> std::same_as<std::size_t>;
  { bus.drop_pending() } -> std::same_as<void>;
  { seen.state() } -> std::same_as<BusState>;
};

}  // namespace offnominal::hal
