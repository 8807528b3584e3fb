#include <array>
#include <cstring>
#include <deque>
#include <offnominal/hal/bus/socketcan.hpp>

#include "common/error.hpp"
#include "sil/open_bus.hpp"
#include "sil/wire.hpp"

namespace offnominal::desk::sil {
namespace {

constexpr hal::Microseconds kPatienceUs = 2'000'000;

[[noreturn]] void give_up(const std::string& interface, const std::string& found,
                          const std::string& mend) {
  throw InputError(
      {"--bus " + interface, "", found, "an interface that is up and carries frames", mend});
}

// One end, on the run's clock: a frame is taken when the interface has carried it, and receive()
// waits for what the other end has sent.
class LockStepPort final : public BusPort {
 public:
  LockStepPort(const std::string& interface, const hal::Microseconds& clock_us)
      : interface_(interface), clock_us_(clock_us) {
    open_bus(interface_,
             {.in_kernel = hal::SocketCanConfig::kMostInKernel, .may_restart_interface = false},
             bus_);
  }

  void connect(LockStepPort& peer) { peer_ = &peer; }

  hal::Microseconds now() override { return clock_us_; }

  hal::Status send(const hal::Frame& frame, hal::Microseconds deadline_us) override {
    if (deadline_us < clock_us_) {
      ++late_;
      return hal::Status::kDeadlinePassed;
    }
    const hal::Microseconds until_us = bus_.now() + kPatienceUs;
    const std::uint32_t before = bus_.state().sent;
    const hal::Status status = bus_.send(frame, until_us);
    if (status != hal::Status::kOk) return status;
    while (bus_.state().sent == before) {
      fetch();
      if (bus_.now() > until_us) give_up(interface_, "a frame that does not go out", "");
    }
    ++carried_;
    return hal::Status::kOk;
  }

  std::size_t receive(std::span<hal::ReceivedFrame> into) override {
    const hal::Microseconds until_us = bus_.now() + kPatienceUs;
    do {
      fetch();
      if (bus_.now() > until_us) give_up(interface_, "frames that do not arrive", "");
    } while (come_ < peer_->carried_);
    std::size_t count = 0;
    while (count < into.size() && !waiting_.empty()) {
      into[count++] = waiting_.front();
      waiting_.pop_front();
    }
    return count;
  }

  void drop_pending() override { bus_.drop_pending(); }

  [[nodiscard]] hal::BusState state() const override {
    hal::BusState state = bus_.state();
    state.late += late_;
    return state;
  }

 private:
  void fetch() {
    std::array<hal::ReceivedFrame, 16> frames;
    const std::size_t count = bus_.receive(frames);
    for (std::size_t i = 0; i < count; ++i) waiting_.push_back({frames[i].frame, clock_us_});
    come_ += count;
  }

  std::string interface_;
  const hal::Microseconds& clock_us_;
  hal::SocketCan bus_;
  LockStepPort* peer_ = nullptr;
  std::deque<hal::ReceivedFrame> waiting_;
  std::uint64_t carried_ = 0;
  std::uint64_t come_ = 0;
  std::uint32_t late_ = 0;
};

class SocketCanWire final : public Wire {
 public:
  explicit SocketCanWire(const std::string& interface)
      : controller_(interface, clock_us_), plant_(interface, clock_us_) {
    controller_.connect(plant_);
    plant_.connect(controller_);
  }
  BusPort& controller() override { return controller_; }
  BusPort& plant() override { return plant_; }
  void set_time(hal::Microseconds now_us) override { clock_us_ = now_us; }

 private:
  hal::Microseconds clock_us_ = 0;
  LockStepPort controller_;
  LockStepPort plant_;
};

}  // namespace

std::unique_ptr<Wire> make_socketcan_wire(const std::string& interface) {
  return std::make_unique<SocketCanWire>(interface);
}

}  // namespace offnominal::desk::sil
