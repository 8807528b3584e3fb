#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

// Semihosting (ARM, Semihosting for AArch32 and AArch64, 2.0): files and the exit of the machine
// that the debugger or QEMU runs on. For tests and measurements; firmware on a machine has none of
// it, a breakpoint without a debugger is a fault.

namespace offnominal::cortex_m {

// Ends the run; `code` is QEMU's exit code.
[[noreturn]] void exit(int code);

// The words that the run was started with, separated by blanks, as a string; "" where they do not
// fit.
[[nodiscard]] const char* command_line(std::span<char> into);

// Text, up to its zero, on the host's console.
void print(const char* text);
void print(std::uint64_t number);

enum class FileMode : std::uint32_t { kRead = 1, kWrite = 5 };  // binary

// A file of the host.
class File {
 public:
  // is_open() tells whether it could be opened.
  File(const char* name, FileMode mode);
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File();

  [[nodiscard]] bool is_open() const { return handle_ >= 0; }
  // Whether all of it was there, and could be written.
  [[nodiscard]] bool read(std::span<std::byte> into);
  [[nodiscard]] bool write(std::span<const std::byte> from);

 private:
  std::int32_t handle_;
};

}  // namespace offnominal::cortex_m
