#include <cstdint>
#include <offnominal/controller/joint_firmware.hpp>
#include <offnominal/controller/static_object.hpp>
#include <offnominal/hal/bus/blank_bus.hpp>

// A joint controller without an operating system. Its bus is the blank one of the package, whose
// copy would drive the chip's CAN controller.

namespace {

namespace hal = offnominal::hal;

using Firmware = offnominal::controller::JointFirmware<hal::BlankBus, float>;

constinit offnominal::controller::StaticObject<hal::BlankBus> bus;
constinit offnominal::controller::StaticObject<Firmware> firmware;

[[noreturn]] void halt() {
  for (;;) asm volatile("wfi");
}

[[noreturn]] void run() {
  firmware.make(bus.make());
  if (firmware->start() != offnominal::Status::kOk) halt();
  const auto at_rest = [](double /*time_s*/) {
    return offnominal::Reference<robot_model::kJoints, float>{};
  };
  for (;;) {
    firmware->tick(bus->now(), 0, at_rest);
    if (firmware->data().state == hal::ControllerState::kPassive) {
      static_cast<void>(firmware->arm(at_rest));  // a refusal is asked again in the next tick
    }
    asm volatile("wfi");  // the timer's interrupt
  }
}

}  // namespace

extern "C" {

extern std::uint32_t data_load;
extern std::uint32_t data_begin;
extern std::uint32_t data_end;
extern std::uint32_t bss_begin;
extern std::uint32_t bss_end;
extern std::uint32_t stack_top;

[[noreturn]] void reset() {
  const std::uint32_t* from = &data_load;
  for (std::uint32_t* to = &data_begin; to != &data_end; ++to, ++from) *to = *from;
  for (std::uint32_t* to = &bss_begin; to != &bss_end; ++to) *to = 0;
  // Full access to the FPU: CPACR of the Armv7-M architecture.
  auto& cpacr = *reinterpret_cast<volatile std::uint32_t*>(0xE000ED88U);
  cpacr = cpacr | 0x00F00000U;
  asm volatile("dsb\n isb");
  run();
}

struct Vectors {
  const void* stack;
  void (*reset)();
  void (*faults[14])();
};
[[gnu::section(".vectors"), gnu::used]] const Vectors vectors{
    &stack_top,
    reset,
    {halt, halt, halt, halt, halt, halt, halt, halt, halt, halt, halt, halt, halt, halt}};
}
