#include "robot/joint_units.hpp"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "common/error.hpp"
#include "robot/units.hpp"

namespace offnominal::desk {
namespace {

// The quantities of a joint, of one that turns and of one that slides.
struct JointQuantity {
  const char* words;
  Dimension turns, slides;
};
constexpr JointQuantity kPosition{"position", Dimension::kAngle, Dimension::kLength};
constexpr JointQuantity kVelocity{"velocity", Dimension::kAngularVelocity, Dimension::kVelocity};
constexpr JointQuantity kTorque{"torque", Dimension::kTorque, Dimension::kForce};

class UnitCheck {
 public:
  UnitCheck(const RobotDescription& robot, const std::string& file) : robot_(robot), file_(file) {}

  void operator()(const Channel& channel, const JointQuantity& quantity, std::size_t joint) const {
    const bool has_scale = channel.scale != 1 || !channel.scale_source.empty();
    if (has_scale) return;
    for (const Channel& term : channel.sum) (*this)(term, quantity, joint);
    const SourceUnit* const unit = find_unit(channel.unit);
    if (unit == nullptr) return;
    const bool turns = robot_.joints[joint].joint.type == JointType::kRevolute;
    const Dimension wanted = turns ? quantity.turns : quantity.slides;
    const Dimension other = turns ? quantity.slides : quantity.turns;
    if (unit->dimension != other) return;
    throw InputError(
        {file_,
         fmt::format("{} of joint {}{}", quantity.words, joint + 1,
                     channel.source.empty() ? "" : ", column " + channel.source),
         fmt::format("the unit {} of a joint that {}", channel.unit, turns ? "turns" : "slides"),
         fmt::format("a unit of {}, or the scale that makes it one", si_name(wanted)),
         "look at the joint's type in the robot file and at the unit under [channels]"});
  }

 private:
  const RobotDescription& robot_;
  const std::string& file_;
};

bool is_of_joint(const std::vector<ChannelOf>& sides, std::size_t joint) {
  return joint >= sides.size() || sides[joint] == ChannelOf::kJoint ||
         sides[joint] == ChannelOf::kSensor;
}

}  // namespace

void check_units_of_joints(const ChannelMap& channels, const RobotDescription& robot,
                           const std::string& file) {
  const UnitCheck check(robot, file);
  for (std::size_t joint = 0; joint < robot.joints.size(); ++joint) {
    if (joint < channels.position.size() && is_of_joint(channels.position_of, joint)) {
      check(channels.position[joint], kPosition, joint);
    }
    if (joint < channels.velocity.size() && channels.velocity[joint] &&
        is_of_joint(channels.velocity_of, joint)) {
      check(*channels.velocity[joint], kVelocity, joint);
    }
    if (joint < channels.torque.size() && is_of_joint(channels.torque_of, joint)) {
      check(channels.torque[joint], kTorque, joint);
    }
    if (joint < channels.sensor_torque.size() && channels.sensor_torque[joint]) {
      check(*channels.sensor_torque[joint], kTorque, joint);
    }
  }
}

}  // namespace offnominal::desk
