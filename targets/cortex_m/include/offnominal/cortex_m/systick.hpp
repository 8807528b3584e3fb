#pragma once

#include <cstdint>

// The core's own timer (ARMv7-M Architecture Reference Manual, B3.3).

namespace offnominal::cortex_m {

namespace detail {
struct SysTick {
  std::uint32_t control;
  std::uint32_t reload;
  std::uint32_t current;
};
inline constexpr std::uint32_t kEnable = 1, kInterrupt = 2, kProcessorClock = 4;
inline constexpr std::uint32_t kMostCounts = 0xFFFFFF;  // 24 bits

[[nodiscard]] inline volatile SysTick& systick() {
  return *reinterpret_cast<volatile SysTick*>(0xE000E010);
}
}  // namespace detail

// Counts per second; that of the MPS2 boards.
inline constexpr std::uint32_t kProcessorHz = 25'000'000;

// systick_handler() every period_us, at most 0.67 s.
inline void start_systick_interrupt(std::int64_t period_us) {
  auto& timer = detail::systick();
  timer.reload = static_cast<std::uint32_t>(period_us * (kProcessorHz / 1'000'000) - 1);
  timer.current = 0;
  timer.control = detail::kEnable | detail::kInterrupt | detail::kProcessorClock;
}

// Counts down from here on, over and over, without an interrupt.
inline void start_systick_counter() {
  auto& timer = detail::systick();
  timer.reload = detail::kMostCounts;
  timer.current = 0;
  timer.control = detail::kEnable | detail::kProcessorClock;
}

// A place in time; counts_since() it, at most 2^24 later.
[[nodiscard]] inline std::uint32_t systick_now() { return detail::systick().current; }
[[nodiscard]] inline std::uint32_t counts_since(std::uint32_t begin) {
  return (begin - systick_now()) & detail::kMostCounts;
}

inline void wait_for_interrupt() { asm volatile("wfi" ::: "memory"); }

// A number that an interrupt writes, read anew each time: its two words belong together where they
// are the same twice.
[[nodiscard]] inline std::uint64_t read_ticks(const std::uint64_t& ticks) {
  const auto& now = *const_cast<const volatile std::uint64_t*>(&ticks);
  std::uint64_t last = now;
  for (std::uint64_t next = now; next != last; next = now) last = next;
  return last;
}

}  // namespace offnominal::cortex_m
