#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "exchange/export_robot.hpp"

namespace offnominal::desk {

// A verb that writes a robot file as another format: its options and what it does.
struct ExportFormat {
  std::string name;  // "URDF"
  exchange::ExportedRobot (*write)(const RobotDescription& robot, const std::string& robot_file);
};
void set_up_export(CLI::App& verb, const ExportFormat& format);

}  // namespace offnominal::desk
