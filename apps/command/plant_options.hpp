#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "robot/robot.hpp"
#include "sil/sil.hpp"

namespace offnominal::desk {

inline constexpr const char* kPaper = "paper";

// --plant and --motion: what stands at the other end of a run that is simulated, and how it moves.
struct PlantOptions {
  std::optional<std::string> plant;
  std::optional<std::string> motion;
};

// What stands behind each in the help: what is taken where it is not given, in words.
void add_plant_options(CLI::App& verb, PlantOptions& options, const std::string& plant_by_default,
                       const std::string& motion_by_default);

// The robot file of the plant, `robot_file` unless --plant names another; none for the paper's arm.
// Of a plant of MuJoCo it says the joints.
[[nodiscard]] std::optional<std::string> plant_file(const PlantOptions& options,
                                                    const std::optional<std::string>& robot_file);

// The plant of a file: a robot with as many joints as the controller's. Throws InputError.
[[nodiscard]] RobotDescription plant_from(const std::string& file, const RobotDescription& robot);

// What --plant says of MuJoCo, and --motion. Throws InputError for a motion that is none.
void put_plant_options(const PlantOptions& options, const RobotDescription& robot,
                       sil::Scenario& scenario);

}  // namespace offnominal::desk
