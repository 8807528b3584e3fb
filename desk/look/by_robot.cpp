#include "look/by_robot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <offnominal/model/quantity.hpp>
#include <utility>

#include "common/nearest.hpp"
#include "log/log_of.hpp"
#include "look/data_units.hpp"
#include "look/looked_columns.hpp"
#include "look/looked_files.hpp"
#include "robot/channel_text.hpp"
#include "robot/channels.hpp"

namespace offnominal::desk {
namespace {

std::string source_words(const Channel& channel) {
  if (!channel.sum.empty()) return list_of(channel.sum, source_words);
  return "`" + channel.source + "`" + (channel.unit.empty() ? "" : " (" + channel.unit + ")");
}

std::string from_words(const char* quantity, const std::vector<ChannelOf>& of, std::size_t joint,
                       const Channel& channel, const RobotDescription& robot) {
  const ChannelOf side = side_at(of, joint);
  const std::string words = channel_key(quantity, side) + " " + source_words(channel);
  const bool shared = side == ChannelOf::kMotor || side == ChannelOf::kCurrent;
  // Where motors are shared, the joint has something of each.
  const bool of_several = shared && robot.transmission && !robot.transmission->matrix.empty();
  return of_several ? words + " and those of the motors that move with it" : words;
}

class RobotLooker {
 public:
  RobotLooker(Look& look, const Log& log, const RobotDescription& robot)
      : look_(look), log_(log), map_(log.channels), robot_(robot) {}

  void say_joint(std::size_t i) {
    const auto at = static_cast<Eigen::Index>(i);
    add(i, "position", Quantity::kPosition, log_.q.col(at),
        from_words("position", map_.position_of, i, map_.position[i], robot_));
    const bool measured = !log_.dq_derived[i] && map_.velocity[i];
    if (!log_.at_rest) {
      add(i, "velocity", Quantity::kVelocity, log_.dq.col(at),
          measured ? from_words("velocity", map_.velocity_of, i, *map_.velocity[i], robot_)
                   : "derived from the position");
    }
    add(i, "torque", Quantity::kEffort, log_.tau.col(at),
        from_words("torque", map_.torque_of, i, map_.torque[i], robot_));
    if (!log_.has_both(i)) return;
    add(i, "sensor torque", Quantity::kEffort, log_.sensor_tau.col(at),
        channel_key("torque", ChannelOf::kSensor) + " " + source_words(*map_.sensor_torque[i]));
  }

 private:
  void add(std::size_t i, const char* words, Quantity quantity,
           const Eigen::Ref<const Eigen::VectorXd>& values, const std::string& from) {
    const RobotJoint& joint = robot_.joints[i];
    look_.by_robot.push_back({joint.name, words, unit_of(quantity, joint.joint.type), from,
                              values.minCoeff(), values.maxCoeff()});
  }

  Look& look_;
  const Log& log_;
  const ChannelMap& map_;
  const RobotDescription& robot_;
};

// Velocities that the file has and the channels do not take, where they go with the positions.
void propose_velocities(Look& look, const RobotDescription& robot) {
  const auto has = [](const auto& channel) { return channel.has_value(); };
  if (std::any_of(look.channels.velocity.begin(), look.channels.velocity.end(), has)) return;
  const Roles roles = roles_of(columns_of(look), expected_of(&robot));
  if (roles.velocity.size() != look.channels.position.size()) return;
  Look with = look;
  with.notes.clear();
  for (std::size_t i = 0; i < roles.velocity.size(); ++i) {
    with.channels.velocity[i] = channel_of(look, roles.velocity[i], Role::kVelocity);
  }
  with.channels.velocity_of = with.channels.position_of;
  if (take_units_from_data(with, &robot) == 0) return;
  look.notes.insert(look.notes.end(), with.notes.begin(), with.notes.end());
  look.to_add = channel_lines(with.channels, "velocity");
}

}  // namespace

Look look_by_channels(const std::filesystem::path& path, const RobotDescription& robot,
                      std::optional<double> period_s) {
  ChannelMap map = *robot.channels;
  if (period_s && !map.at_rest) map.period_s = *period_s;
  ReadFiles read = read_files_of(path, map, bus_of(robot));
  Look look = look_of(read.all);
  if (map.at_rest) {
    look.notes.emplace_back(
        "the channels are those of a hold map (at_rest = true): readings at "
        "rest, without a time");
  } else {
    set_time(look, read.recording.time.t_s);
    if (map.more_times.empty()) take_for_no_time_but(look, map.time.source);
  }
  const Log log = log_of(std::move(read.recording), robot, map);
  RobotLooker looker(look, log, robot);
  for (std::size_t i = 0; i < robot.joints.size(); ++i) looker.say_joint(i);
  look.remarks = log.remarks;
  look.channels = map;
  if (!map.at_rest) propose_velocities(look, robot);
  return look;
}

}  // namespace offnominal::desk
