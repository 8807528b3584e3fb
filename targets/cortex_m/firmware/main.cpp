// Firmware as it would run on a machine: a tick per SysTick interrupt, on a bus without a wire.
// With the chip's CAN controller in BlankBus's place it commands the robot.
#include <cstdint>
#include <offnominal/controller/joint_firmware.hpp>
#include <offnominal/controller/static_object.hpp>
#include <offnominal/hal/bus/blank_bus.hpp>

#include "offnominal/cortex_m/semihosting.hpp"
#include "offnominal/cortex_m/systick.hpp"

namespace offnominal::cortex_m {
namespace {

// The chip's timer in its place, see blank_bus.hpp; here ticks are counted.
class Bus : public hal::BlankBus {
 public:
  [[nodiscard]] hal::Microseconds now() const { return now_us_; }
  void advance(hal::Microseconds period_us) { now_us_ += period_us; }

 private:
  hal::Microseconds now_us_ = 0;
};

using Firmware = controller::JointFirmware<Bus, float>;

constinit controller::StaticObject<Bus> bus;
constinit controller::StaticObject<Firmware> firmware;

// The joints stay where the robot's coordinates are zero.
Reference<Firmware::kJoints, float> hold(double /*time_s*/) { return {}; }

}  // namespace
}  // namespace offnominal::cortex_m

extern "C" void systick_handler() {
  using namespace offnominal::cortex_m;
  bus->advance(Firmware::kPeriodUs);
  firmware->tick(bus->now(), 0, hold);
}

int main() {
  using namespace offnominal::cortex_m;
  firmware.make(bus.make());
  if (firmware->start() != offnominal::Status::kOk) return 1;
  start_systick_interrupt(Firmware::kPeriodUs);
  // A run of QEMU has an end. Without a bus the controller must still be waiting for its joints.
  while (read_ticks(firmware->data().ticks) < 100) wait_for_interrupt();
  return firmware->data().state == offnominal::hal::ControllerState::kInit ? 0 : 1;
}
