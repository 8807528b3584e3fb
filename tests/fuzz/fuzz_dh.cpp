// A DH table that is none, as CSV and as TOML: read_dh_table() refuses it with an InputError, or
// its robot file says in reading that masses are blank, and with masses it is read again.

#include <cstdlib>
#include <string>

#include "common/error.hpp"
#include "exchange/blank_robot.hpp"
#include "exchange/dh_table.hpp"
#include "input_file.hpp"
#include "robot/robot_file.hpp"

namespace {

using namespace offnominal;

bool is_refused(const std::string& text) {
  try {
    static_cast<void>(desk::parse_robot(text, "blank.toml"));
  } catch (const desk::InputError&) {
    return true;
  }
  return false;
}

void read_as(const char* extension, const std::uint8_t* data, std::size_t size) {
  const auto path = fuzz::input_file(data, size, extension);
  desk::exchange::DhTable table;
  try {
    table = desk::exchange::read_dh_table(path, desk::exchange::DhConvention::kModified);
  } catch (const desk::InputError&) {
    return;
  }
  if (!is_refused(desk::exchange::blank_robot_text(table, "fuzz", "fuzz.csv"))) std::abort();
  desk::RobotDescription robot;
  robot.name = "fuzz";
  robot.joints = desk::exchange::joints_of(table);
  for (desk::RobotJoint& joint : robot.joints) joint.joint.mass_kg = 1;
  const std::string written = desk::robot_text(robot);
  if (desk::robot_text(desk::parse_robot(written, "written.toml")) != written) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  read_as(".csv", data, size);
  read_as(".toml", data, size);
  return 0;
}
