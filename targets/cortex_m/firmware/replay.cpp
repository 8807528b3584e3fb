// Runs the joint controller on the frames of a file and writes what came of every tick into
// another:
//   <program> TICKS INPUT OUTPUT
#include <array>
#include <cstddef>
#include <cstdint>
#include <offnominal/controller/static_object.hpp>
#include <span>

#include "offnominal/cortex_m/semihosting.hpp"
#include "replay_run.hpp"

namespace offnominal::cortex_m {
namespace {

enum ExitCode : int { kDone = 0, kWrongCall = 3, kNoFile = 4, kRefused = 5, kCutShort = 6 };

constinit controller::StaticObject<ReplayRun<OFFNOMINAL_SCALAR>> run;
constinit controller::StaticObject<ReplayTick> tick;
constinit controller::StaticObject<ReplayResult> result;

// Cuts the line's next word off, null where there is none.
char* next_word(char*& line) {
  while (*line == ' ') ++line;
  if (*line == '\0') return nullptr;
  char* const word = line;
  while (*line != ' ' && *line != '\0') ++line;
  if (*line == ' ') *line++ = '\0';
  return word;
}

int replay() {
  std::array<char, 1024> line{};
  static_cast<void>(command_line(line));
  char* rest = line.data();
  static_cast<void>(next_word(rest));
  const char* const ticks = next_word(rest);
  const char* const input_name = next_word(rest);
  const char* const output_name = next_word(rest);
  if (output_name == nullptr) return kWrongCall;
  std::uint32_t count = 0;
  for (const char* digit = ticks; *digit != '\0'; ++digit) {
    count = 10 * count + static_cast<std::uint32_t>(*digit - '0');
  }

  File input(input_name, FileMode::kRead);
  File output(output_name, FileMode::kWrite);
  if (!input.is_open() || !output.is_open()) return kNoFile;
  if (run.make().start() != Status::kOk) return kRefused;
  tick.make();
  result.make();
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!input.read(std::as_writable_bytes(std::span(&*tick, 1)))) return kCutShort;
    run->tick(*tick, *result);
    if (!output.write(std::as_bytes(std::span(&*result, 1)))) return kCutShort;
  }
  return kDone;
}

}  // namespace
}  // namespace offnominal::cortex_m

int main() { return offnominal::cortex_m::replay(); }
