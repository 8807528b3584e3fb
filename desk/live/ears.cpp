#include <array>
#include <cstring>
#include <offnominal/hal/bus/can_listener.hpp>

#include "common/error.hpp"
#include "live/feed.hpp"

namespace offnominal::desk::live {
namespace {

class Ears final : public Feed {
 public:
  explicit Ears(const std::string& interface) : interface_(interface) {
    const hal::Status status = bus_.open(interface.c_str());
    if (status == hal::Status::kOk) return;
    throw InputError(
        {"--bus " + interface, "",
         std::string(hal::name_of(status)) + " (" + std::strerror(bus_.error_number()) + ")",
         "a CAN interface that is up",
         "`ip link` lists them; make a virtual one: ip link add vcan0 type vcan && ip link set "
         "vcan0 mtu 72 up; where the kernel has no CAN: ./dev vcan COMMAND"});
  }

  void take(const OnFrame& on_frame) override {
    constexpr hal::Microseconds kPatienceUs = 20'000;
    std::array<hal::ReceivedFrame, 256> frames;
    const std::size_t count = bus_.receive(frames, kPatienceUs);
    for (std::size_t i = 0; i < count; ++i) on_frame(frames[i]);
  }
  [[nodiscard]] hal::Microseconds now_us() const override { return bus_.now(); }
  [[nodiscard]] std::string ended() const override { return {}; }
  [[nodiscard]] std::uint64_t overflow() const override { return bus_.overflow(); }
  [[nodiscard]] std::string remark() const override {
    return bus_.is_up() ? "" : "The interface " + interface_ + " is down.";
  }

 private:
  std::string interface_;
  hal::CanListener bus_;
};

}  // namespace

std::unique_ptr<Feed> make_ears(const std::string& interface) {
  return std::make_unique<Ears>(interface);
}

}  // namespace offnominal::desk::live
