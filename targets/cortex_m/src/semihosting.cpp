#include <array>
#include <cstring>
#include <offnominal/cortex_m/semihosting.hpp>

namespace offnominal::cortex_m {
namespace {

enum class Operation : std::uint32_t {
  kOpen = 0x01,
  kClose = 0x02,
  kWrite0 = 0x04,
  kWrite = 0x05,
  kRead = 0x06,
  kGetCommandLine = 0x15,
  kExitExtended = 0x20,
};

using Word = std::uint32_t;

template <typename T>
Word address_of(T* object) {
  return reinterpret_cast<Word>(object);
}

std::int32_t call(Operation operation, Word argument) {
  register Word r0 asm("r0") = static_cast<Word>(operation);
  register Word r1 asm("r1") = argument;
  asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
  return static_cast<std::int32_t>(r0);
}

template <std::size_t Count>
std::int32_t call(Operation operation, const std::array<Word, Count>& arguments) {
  return call(operation, address_of(arguments.data()));
}

}  // namespace

void exit(int code) {
  constexpr Word kApplicationExit = 0x20026;
  call(Operation::kExitExtended, std::array{kApplicationExit, static_cast<Word>(code)});
  for (;;) {
  }
}

const char* command_line(std::span<char> into) {
  std::array<Word, 2> block{address_of(into.data()), static_cast<Word>(into.size())};
  const bool got = call(Operation::kGetCommandLine, block) == 0;
  return got ? into.data() : "";
}

void print(const char* text) { call(Operation::kWrite0, address_of(text)); }

void print(std::uint64_t number) {
  std::array<char, 21> digits{};
  std::size_t at = digits.size() - 1;
  do {
    digits[--at] = static_cast<char>('0' + number % 10);
    number /= 10;
  } while (number != 0);
  print(&digits[at]);
}

File::File(const char* name, FileMode mode)
    : handle_(call(Operation::kOpen, std::array{address_of(name), static_cast<Word>(mode),
                                                static_cast<Word>(std::strlen(name))})) {}

File::~File() {
  if (is_open()) call(Operation::kClose, std::array{static_cast<Word>(handle_)});
}

// Both operations return how many bytes are left.
bool File::read(std::span<std::byte> into) {
  return call(Operation::kRead, std::array{static_cast<Word>(handle_), address_of(into.data()),
                                           static_cast<Word>(into.size())}) == 0;
}

bool File::write(std::span<const std::byte> from) {
  return call(Operation::kWrite, std::array{static_cast<Word>(handle_), address_of(from.data()),
                                            static_cast<Word>(from.size())}) == 0;
}

}  // namespace offnominal::cortex_m
