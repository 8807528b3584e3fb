// A robot file that is none: parse_robot() refuses it with an InputError, or what it reads can be
// written and read again, the same.

#include <cstdlib>
#include <string>
#include <string_view>

#include "common/error.hpp"
#include "robot/robot_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace offnominal;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  desk::RobotDescription robot;
  try {
    robot = desk::parse_robot(text, "fuzz.toml");
  } catch (const desk::InputError&) {
    return 0;
  }
  const std::string written = desk::robot_text(robot);
  if (desk::robot_text(desk::parse_robot(written, "written.toml")) != written) std::abort();
  return 0;
}
