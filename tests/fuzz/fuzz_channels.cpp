// A channel map that is none: read_channels_file() refuses it with an InputError.

#include "common/error.hpp"
#include "input_file.hpp"
#include "robot/channels.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace offnominal;
  const auto path = fuzz::input_file(data, size, ".toml");
  try {
    static_cast<void>(desk::read_channels_file(path, 2));
  } catch (const desk::InputError&) {
  }
  return 0;
}
