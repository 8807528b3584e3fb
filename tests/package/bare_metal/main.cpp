#include <cstdint>
#include <offnominal/controller/joint_controller.hpp>
#include <offnominal/hal/blank_bus.hpp>
#include <offnominal/hal/protected_drives.hpp>

#include "robot_model.hpp"

// A joint controller without an operating system. Its bus is the blank one of the package, whose
// copy would drive the chip's CAN controller.

namespace {

namespace hal = offnominal::hal;

using Controller =
    offnominal::controller::JointController<robot_model::kJoints, robot_model::kHiddenUnits, float>;

[[noreturn]] void halt() {
  for (;;) asm volatile("wfi");
}

[[noreturn]] void run() {
  Controller::Config config;
  config.monitor = robot_model::kMonitorConfig<float>;
  config.gains = robot_model::kComputedTorqueGains<float>;
  static Controller controller;
  if (Controller::create(config, controller) != offnominal::Status::kOk) halt();
  static Controller::Data data;
  static hal::ProtectedDrives<robot_model::kJoints> drives({}, {}, hal::FrameFormat::kClassic);
  hal::BlankBus bus;
  const auto at_rest = [](float) { return offnominal::Reference<robot_model::kJoints, float>{}; };
  for (;;) {
    controller.step(bus.now(), 0, at_rest, bus, drives, data);
    if (data.state == hal::ControllerState::kPassive) static_cast<void>(controller.arm(data));
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
