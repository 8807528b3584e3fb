#pragma once

#include <cstddef>
#include <memory>

// Ticks of an adapting monitor from a unit that holds one size and one caller: the best that the
// compiler makes of it. What a unit with all sizes makes is compared with it.

namespace tick_alone {

class Ticks {
 public:
  Ticks() = default;
  Ticks(const Ticks&) = delete;
  Ticks& operator=(const Ticks&) = delete;
  virtual ~Ticks() = default;
  virtual void step(std::size_t k) = 0;
};

// tick_alone.cpp of a size, compiled by CMakeLists.txt.
std::unique_ptr<Ticks> ticks_2x35_float();
std::unique_ptr<Ticks> ticks_2x35_double();
std::unique_ptr<Ticks> ticks_7x64_float();
std::unique_ptr<Ticks> ticks_7x64_double();

}  // namespace tick_alone
