#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace offnominal::desk::wcet {

/// Empties the caches of what a tick needs: `memory` and the program's code with that of the
/// mathematical library. Where the processor has no instruction for it that a program may use, by
/// reading a block larger than the caches.
class CacheFlush {
 public:
  CacheFlush();
  void flush(std::span<const std::byte> memory);
  /// How it is done, in words.
  [[nodiscard]] const char* method() const;

 private:
  std::vector<std::span<const std::byte>> code_;
  std::vector<std::byte> block_;
};

}  // namespace offnominal::desk::wcet
