// One end of any bus, so that a run is compiled once for all of them.
#pragma once

#include <cstddef>
#include <functional>
#include <offnominal/hal/bus/bus.hpp>
#include <span>
#include <utility>

namespace offnominal::desk {

class BusPort {
 public:
  virtual ~BusPort() = default;
  virtual hal::Microseconds now() = 0;
  virtual hal::Status send(const hal::Frame& frame, hal::Microseconds deadline_us) = 0;
  virtual std::size_t receive(std::span<hal::ReceivedFrame> into) = 0;
  virtual void drop_pending() = 0;
  [[nodiscard]] virtual hal::BusState state() const = 0;
};
static_assert(hal::Bus<BusPort>);

/// Of a bus of its own, or of another's: BusPortOf<hal::SocketCan&>.
template <hal::Bus B>
class BusPortOf final : public BusPort {
 public:
  explicit BusPortOf(B bus) : bus_(std::forward<B>(bus)) {}
  hal::Microseconds now() override { return bus_.now(); }
  hal::Status send(const hal::Frame& frame, hal::Microseconds deadline_us) override {
    return bus_.send(frame, deadline_us);
  }
  std::size_t receive(std::span<hal::ReceivedFrame> into) override { return bus_.receive(into); }
  void drop_pending() override { bus_.drop_pending(); }
  [[nodiscard]] hal::BusState state() const override { return bus_.state(); }

 private:
  B bus_;
};

// Another's port, and somebody who sees every frame that it takes.
class TappedPort final : public BusPort {
 public:
  using OnFrame = std::function<void(const hal::Frame& frame, hal::Microseconds time_us)>;

  TappedPort(BusPort& port, OnFrame on_frame) : port_(port), on_frame_(std::move(on_frame)) {}
  hal::Microseconds now() override { return port_.now(); }
  hal::Status send(const hal::Frame& frame, hal::Microseconds deadline_us) override {
    const hal::Status status = port_.send(frame, deadline_us);
    if (status == hal::Status::kOk && on_frame_) on_frame_(frame, port_.now());
    return status;
  }
  std::size_t receive(std::span<hal::ReceivedFrame> into) override { return port_.receive(into); }
  void drop_pending() override { port_.drop_pending(); }
  [[nodiscard]] hal::BusState state() const override { return port_.state(); }

 private:
  BusPort& port_;
  OnFrame on_frame_;
};

}  // namespace offnominal::desk
