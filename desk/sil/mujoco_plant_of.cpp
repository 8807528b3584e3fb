#include "sil/mujoco_plant_of.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <string_view>
#include <vector>

#include "common/error.hpp"
#include "offnominal/sim/plants/mujoco_plant.hpp"

namespace offnominal::desk::sil {
namespace {

sim::MujocoModel model_of(const Scenario& scenario) {
  try {
    return sim::MujocoModel::from_file(*scenario.mujoco);
  } catch (const std::runtime_error& error) {
    throw InputError({*scenario.mujoco, "", error.what(), "an MJCF or a URDF of a robot",
                      "offnominal export-mjcf writes one of a robot file"});
  }
}

const char* type_name(bool turns) { return turns ? "turns" : "slides"; }

}  // namespace

std::optional<std::string> mujoco_file_named(const std::string& plant) {
  const std::string_view prefix = kMujocoPrefix;
  if (!plant.starts_with(prefix)) return std::nullopt;
  return plant.substr(prefix.size());
}

void check_mujoco_plant(const Scenario& scenario) {
  const std::vector<sim::MujocoJoint> joints = model_of(scenario).joints();
  const std::vector<RobotJoint>& wanted = scenario.plant->joints;
  const std::string& file = *scenario.mujoco;
  const std::string robot = "robot " + scenario.plant->name;
  if (joints.size() != wanted.size()) {
    throw InputError({file, "joints", fmt::format("{} of them", joints.size()),
                      fmt::format("{}, as {} has", wanted.size(), robot),
                      "weld what the robot file does not know, or take the file of this robot"});
  }
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const bool turns = wanted[i].joint.type == JointType::kRevolute;
    if (joints[i].turns != turns) {
      throw InputError({file, fmt::format("joint {}, {}", i + 1, joints[i].name),
                        fmt::format("one that {}", type_name(joints[i].turns)),
                        fmt::format("one that {}, as in {}", type_name(turns), robot), ""});
    }
    for (std::size_t other = 0; other < wanted.size(); ++other) {
      if (other == i || wanted[other].name != joints[i].name) continue;
      throw InputError(
          {file, fmt::format("joint {}", i + 1), joints[i].name,
           fmt::format("{}, as in {}: joints stand in one order", wanted[i].name, robot), ""});
    }
  }
  if (scenario.hidden.empty()) return;
  throw InputError({"sil", "hidden", "an effect hidden in a plant of MuJoCo",
                    "none: its friction, damping and armature are those of its file",
                    "write what is hidden into " + file});
}

std::unique_ptr<sim::Plant> make_mujoco_plant(const Scenario& scenario,
                                              const sim::JointState& start) {
  return std::make_unique<sim::MujocoPlant>(
      model_of(scenario), sim::MujocoSetup{.start = start, .faults = scenario.faults});
}

}  // namespace offnominal::desk::sil
