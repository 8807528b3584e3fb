#pragma once

#include <cstdint>
#include <string_view>

namespace offnominal::desk::studio {

/// FNV-1a, 64 bits: tells whether something is what it was, to those who mean no harm.
class Fingerprint {
 public:
  void add(std::string_view bytes) {
    for (const char byte : bytes) {
      value_ = (value_ ^ static_cast<unsigned char>(byte)) * 0x100000001b3U;
    }
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325U;
};

}  // namespace offnominal::desk::studio
