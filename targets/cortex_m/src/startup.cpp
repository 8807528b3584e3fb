// From reset to main(): Cortex-M4F and M7, no vendor files.
#include <cstdint>
#include <offnominal/cortex_m/semihosting.hpp>

extern "C" {
// Of the linker script.
extern std::uint32_t firmware_stack_top;
extern std::uint32_t firmware_data_begin;
extern std::uint32_t firmware_data_end;
extern const std::uint32_t firmware_data_image;
extern std::uint32_t firmware_bss_begin;
extern std::uint32_t firmware_bss_end;

int main();
void reset_handler();
[[noreturn]] void start_program();
void fault_handler();
void systick_handler();

// Nothing is done between main()'s end and this: statics of firmware live for ever.
[[noreturn]] void start_program() {
  const std::uint32_t* from = &firmware_data_image;
  for (std::uint32_t* to = &firmware_data_begin; to != &firmware_data_end;) *to++ = *from++;
  for (std::uint32_t* to = &firmware_bss_begin; to != &firmware_bss_end;) *to++ = 0;
  offnominal::cortex_m::exit(main());
}

// The FPU is off after reset (ARMv7-M Architecture Reference Manual, B3.2.20, CPACR): full access
// to CP10 and CP11 before the first floating-point instruction.
__attribute__((naked)) void reset_handler() {
  asm volatile(
      "ldr r0, =0xE000ED88\n"
      "ldr r1, [r0]\n"
      "orr r1, r1, #(0xF << 20)\n"
      "str r1, [r0]\n"
      "dsb\n"
      "isb\n"
      "b start_program\n");
}

// Any fault and any interrupt that nobody has asked for: firmware on a machine goes to its safe
// state here.
void fault_handler() { offnominal::cortex_m::exit(2); }

__attribute__((weak)) void systick_handler() { fault_handler(); }
}

namespace {

using Handler = void (*)();
struct VectorTable {
  std::uint32_t* stack_top;
  Handler handlers[15];
};

}  // namespace

// Initial stack pointer, then reset, NMI, the faults, SVCall, debug, PendSV, SysTick.
extern "C" __attribute__((section(".vectors"), used)) const VectorTable firmware_vectors = {
    &firmware_stack_top,
    {reset_handler, fault_handler, fault_handler, fault_handler, fault_handler, fault_handler,
     nullptr, nullptr, nullptr, nullptr, fault_handler, fault_handler, nullptr, fault_handler,
     systick_handler}};
