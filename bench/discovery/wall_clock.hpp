#pragma once

#include <chrono>

namespace offnominal::bench {

// Seconds since some start, for differences.
inline double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace offnominal::bench
