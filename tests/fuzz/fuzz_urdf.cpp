// A URDF that is none: import_urdf() refuses it with an InputError, or what it reads is a robot
// file that is read again, and that simulators get as URDF, which is the same chain, and as MJCF.

#include <cstdlib>
#include <string>
#include <string_view>

#include "common/error.hpp"
#include "common/json_text.hpp"
#include "exchange/export_robot.hpp"
#include "exchange/import_report.hpp"
#include "exchange/import_urdf.hpp"
#include "robot/robot_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace offnominal;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  desk::exchange::ImportedRobot imported;
  try {
    imported = desk::exchange::import_urdf(text, "fuzz.urdf");
  } catch (const desk::InputError&) {
    return 0;
  }
  if (desk::exchange::text_of(imported).empty()) std::abort();
  static_cast<void>(desk::json_text(desk::exchange::to_json(imported)));
  desk::RobotDescription robot;
  try {
    robot = desk::parse_robot(desk::exchange::robot_text_of(imported, "fuzz.urdf"), "fuzz.toml");
  } catch (const desk::InputError&) {
    // A number that the chain as a whole has and no robot file takes: the verb refuses it.
    return 0;
  }
  static_cast<void>(desk::exchange::export_mjcf(robot, "fuzz.toml"));
  const auto urdf = desk::exchange::export_urdf(robot, "fuzz.toml");
  const auto again = desk::exchange::import_urdf(urdf.text, "written.urdf", {"base", std::nullopt});
  if (again.robot.joint_count() != robot.joint_count()) std::abort();
  return 0;
}
