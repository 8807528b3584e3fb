// Programs of the firmware in QEMU's MPS2 boards.
#pragma once

#include <string>
#include <vector>

namespace offnominal::test {

struct Board {
  const char* machine;  // of qemu-system-arm
  const char* preset;   // whose build folder has the programs
};
inline constexpr Board kCortexM7{"mps2-an500", "cortex-m7"};
inline constexpr Board kCortexM4{"mps2-an386", "cortex-m4"};

/// Runs `<program> <arguments>` on the board and returns its exit code. Throws std::runtime_error
/// where there is no such program or no QEMU. The arguments must hold no blanks and no commas.
int run_on(const Board& board, const std::string& program,
           const std::vector<std::string>& arguments);

}  // namespace offnominal::test
