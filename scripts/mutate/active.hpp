// In front of every unit that is built for ./dev mutate: which wrong version runs.
#pragma once

namespace offnominal_mutate {

bool is_chosen(int number) noexcept;

// What the compiler computes is right.
constexpr bool is_active(int number) noexcept {
  return !__builtin_is_constant_evaluated() && is_chosen(number);
}

}  // namespace offnominal_mutate
