#pragma once

#include <cstddef>
#include <offnominal/hal/bus/bus.hpp>
#include <offnominal/realtime/recorder.hpp>
#include <span>

namespace offnominal::realtime {

// A bus of which every frame is recorded: one that was received by the time at which it came, one
// to be sent when the bus has taken it.
template <hal::Bus Inner>
class RecordedBus {
 public:
  // Both have to outlive it.
  RecordedBus(Inner& inner, Recorder& recorder) : inner_(inner), recorder_(recorder) {}

  [[nodiscard]] Microseconds now() { return inner_.now(); }
  [[nodiscard]] hal::Status send(const hal::Frame& frame, Microseconds deadline_us) {
    const hal::Status status = inner_.send(frame, deadline_us);
    if (status == hal::Status::kOk) recorder_.keep(FrameEntry{frame, inner_.now()});
    return status;
  }
  [[nodiscard]] std::size_t receive(std::span<hal::ReceivedFrame> into) {
    const std::size_t count = inner_.receive(into);
    for (const hal::ReceivedFrame& received : into.first(count)) {
      recorder_.keep(FrameEntry{received.frame, received.time_us});
    }
    return count;
  }
  void drop_pending() { inner_.drop_pending(); }
  [[nodiscard]] hal::BusState state() const { return inner_.state(); }

 private:
  Inner& inner_;
  Recorder& recorder_;
};

}  // namespace offnominal::realtime
