#include "log/seen_by_sensor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <offnominal/model/effect_list.hpp>
#include <string_view>

#include "common/error.hpp"
#include "common/nearest.hpp"
#include "robot/effect_text.hpp"
#include "robot/transmission.hpp"

namespace offnominal::desk {
namespace {

bool is_hidden(const RobotDescription& robot, const RobotEffect& effect, const Log& log) {
  if (!effect.of_motor) {
    return log.of_sensor(effect.joint) && info_of(effect.kind)->traits.is_before_sensor;
  }
  // What gives way moves the links, wherever torques are measured.
  if (info_of(effect.kind)->action == EffectAction::kDisplacement) return false;
  const Eigen::MatrixXd matrix = motor_per_joint(*robot.transmission);
  for (std::size_t joint = 0; joint < robot.joints.size(); ++joint) {
    const bool moves = matrix(effect.joint, static_cast<Eigen::Index>(joint)) != 0;
    if (moves && log.of_sensor(joint)) return true;
  }
  return false;
}

}  // namespace

std::vector<std::size_t> hidden_from_sensors(const RobotDescription& robot, const Log& log) {
  std::vector<std::size_t> hidden;
  for (std::size_t i = 0; i < robot.effects.size(); ++i) {
    if (is_hidden(robot, robot.effects[i], log)) hidden.push_back(i);
  }
  return hidden;
}

RobotDescription seen_by_sensors(const RobotDescription& robot, const Log& log) {
  RobotDescription seen = robot;
  std::erase_if(seen.effects,
                [&](const RobotEffect& effect) { return is_hidden(robot, effect, log); });
  return seen;
}

void refuse_hidden_from_sensors(const RobotDescription& robot, const Log& log) {
  const std::vector<std::size_t> hidden = hidden_from_sensors(robot, log);
  if (hidden.empty()) return;
  const RobotEffect& first = robot.effects[hidden.front()];
  throw InputError({log.file, "channels.sensor_torque",
                    fmt::format("torques of a sensor behind the gear, which does not see {} of {}",
                                info_of(first.kind)->name, place_of(first)),
                    "torques or currents of the drive, or a fit without that effect",
                    "leave it out of what is added, and of a copy of the robot file for this fit"});
}

std::string words_of_sensors(const Log& log) {
  std::vector<std::string> joints;
  for (std::size_t joint = 0; joint < log.channels.torque_of.size(); ++joint) {
    if (log.of_sensor(joint)) joints.push_back(std::to_string(joint + 1));
  }
  if (joints.empty()) return {};
  std::vector<std::string> hidden;
  for (const EffectInfo& info : kAllEffectInfos) {
    if (info.traits.is_before_sensor) hidden.emplace_back(info.name);
  }
  return fmt::format(
      "the torque of joint{} {} is that of a sensor behind the gear: effects of motors, and {}, do "
      "not show in it, and are not looked for",
      joints.size() == 1 ? "" : "s", list_of(joints), list_of(hidden));
}

}  // namespace offnominal::desk
