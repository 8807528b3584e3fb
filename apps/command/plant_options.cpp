#include "command/plant_options.hpp"

#include <fmt/format.h>

#include "common/error.hpp"
#include "loop/motion_at.hpp"
#include "robot/robot_file.hpp"
#include "sil/mujoco_plant_of.hpp"

namespace offnominal::desk {

void add_plant_options(CLI::App& verb, PlantOptions& options, const std::string& plant_by_default,
                       const std::string& motion_by_default) {
  verb.add_option("--plant", options.plant,
                  "Robot file of the plant, its rigid body and effects; mujoco:FILE, an MJCF or "
                  "URDF with the controller's joints" +
                      plant_by_default);
  verb.add_option("--motion", options.motion,
                  "paper, sway (every joint a little to and fro), or a CSV as offnominal motion "
                  "writes it" +
                      motion_by_default);
}

std::optional<std::string> plant_file(const PlantOptions& options,
                                      const std::optional<std::string>& robot_file) {
  if (!options.plant || sil::mujoco_file_named(*options.plant)) return robot_file;
  return *options.plant == kPaper ? std::nullopt : options.plant;
}

RobotDescription plant_from(const std::string& file, const RobotDescription& robot) {
  RobotDescription plant = read_robot_file(file);
  if (plant.joint_count() == robot.joint_count()) return plant;
  throw InputError({file, "[[joint]]",
                    fmt::format("robot {} with {} joint(s)", plant.name, plant.joint_count()),
                    fmt::format("a plant with {}, as many as robot {} of the controller has",
                                robot.joint_count(), robot.name),
                    "give --plant and --robot files of the same arm"});
}

void put_plant_options(const PlantOptions& options, const RobotDescription& robot,
                       sil::Scenario& scenario) {
  if (options.plant) scenario.mujoco = sil::mujoco_file_named(*options.plant);
  if (options.motion) scenario.motion = motion_named(*options.motion, robot);
}

}  // namespace offnominal::desk
