#include "wcet/cache.hpp"

#include <link.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <string_view>

namespace offnominal::desk::wcet {
namespace {

#if defined(__x86_64__)
constexpr bool kHasFlush = true;
void flush_lines(std::span<const std::byte> memory) {
  constexpr std::size_t kLine = 64;
  for (std::size_t i = 0; i < memory.size(); i += kLine) {
    __builtin_ia32_clflush(memory.data() + i);
  }
  if (!memory.empty()) __builtin_ia32_clflush(memory.data() + memory.size() - 1);
}
void wait_for_flush() { __builtin_ia32_mfence(); }
#else
constexpr bool kHasFlush = false;
void flush_lines(std::span<const std::byte> /*memory*/) {}
void wait_for_flush() {}
#endif

// Executable parts of the program itself (whose name is empty) and of libm.
int add_code(dl_phdr_info* info, std::size_t /*size*/, void* into) {
  const std::string_view name = info->dlpi_name == nullptr ? "" : info->dlpi_name;
  if (!name.empty() && name.find("/libm.") == std::string_view::npos) return 0;
  auto& code = *static_cast<std::vector<std::span<const std::byte>>*>(into);
  for (int i = 0; i < info->dlpi_phnum; ++i) {
    const auto& part = info->dlpi_phdr[i];
    if (part.p_type != PT_LOAD || (part.p_flags & PF_X) == 0) continue;
    const std::uintptr_t begin = info->dlpi_addr + part.p_vaddr;
    // NOLINTNEXTLINE(performance-no-int-to-ptr): the loader says where it put the code.
    code.emplace_back(reinterpret_cast<const std::byte*>(begin), part.p_memsz);
  }
  return 0;
}

std::size_t block_size() {
  constexpr long kLeast = 8L << 20;
  constexpr long kMost = 128L << 20;
  return static_cast<std::size_t>(std::clamp(2 * ::sysconf(_SC_LEVEL3_CACHE_SIZE), kLeast, kMost));
}

}  // namespace

CacheFlush::CacheFlush() {
  if (kHasFlush) {
    ::dl_iterate_phdr(add_code, &code_);
  } else {
    block_.resize(block_size());
  }
}

void CacheFlush::flush(std::span<const std::byte> memory) {
  for (std::byte& byte : block_) byte ^= std::byte{1};
  for (const auto& part : code_) flush_lines(part);
  flush_lines(memory);
  wait_for_flush();
}

const char* CacheFlush::method() const {
  return kHasFlush ? "clflush of the tick's memory, the program's code and libm's"
                   : "a block larger than the caches is written";
}

}  // namespace offnominal::desk::wcet
