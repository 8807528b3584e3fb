// The wrong version that OFFNOMINAL_MUTANT names runs. OFFNOMINAL_MUTANTS_REACHED names a file for
// the numbers of those that have been come by.
#include "active.hpp"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdio>
#include <cstdlib>

namespace offnominal_mutate {
namespace {

// Larger than the errors that one file has.
std::array<std::atomic<bool>, 1U << 16U> reached;

struct Report {
  ~Report() {
    const char* name = std::getenv("OFFNOMINAL_MUTANTS_REACHED");
    std::FILE* file = name == nullptr ? nullptr : std::fopen(name, "w");
    if (file == nullptr) return;
    for (std::size_t i = 0; i < reached.size(); ++i) {
      if (reached[i]) std::fprintf(file, "%zu\n", i);
    }
    std::fclose(file);
  }
} report;

int chosen() noexcept {
  static const char* const number = std::getenv("OFFNOMINAL_MUTANT");
  static const int value = number == nullptr ? 0 : std::atoi(number);
  return value;
}

}  // namespace

bool is_chosen(int number) noexcept {
  reached[static_cast<std::size_t>(number) % reached.size()].store(true, std::memory_order_relaxed);
  return number == chosen();
}

}  // namespace offnominal_mutate
