// Lines of a recording as text, without the heap.
#pragma once

#include <cstddef>
#include <offnominal/realtime/recorder.hpp>
#include <span>

namespace offnominal::realtime {

inline constexpr std::size_t kLongestLine = 4096;

// Each writes one line, its end included, and returns its length.
[[nodiscard]] std::size_t candump_text(const FrameEntry& entry, const char* interface,
                                       std::span<char, kLongestLine> into);
// `values`: how many of the row's numbers there are.
[[nodiscard]] std::size_t row_text(const Row& row, std::size_t values,
                                   std::span<char, kLongestLine> into);

}  // namespace offnominal::realtime
