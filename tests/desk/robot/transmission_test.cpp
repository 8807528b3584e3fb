#include "robot/transmission.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <string>

#include "common/error.hpp"
#include "desk/support/temporary_file.hpp"
#include "robot/robot_file.hpp"
#include "sample_robot.hpp"

namespace offnominal::test {
namespace {

using desk::ChannelOf;
using desk::InputError;
using desk::parse_robot;
using desk::RobotDescription;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Two joints of nothing in particular, and what is added to them.
std::string two_joints(const std::string& more) {
  return R"(format = 1
name = "wrist"
gravity_m_s2 = [0, 0, -9.81]
[[joint]]
name = "pitch"
type = "revolute"
axis = [0, 1, 0]
[joint.link]
mass_kg = 1
centre_of_mass_m = [0.1, 0, 0]
[[joint]]
name = "roll"
type = "revolute"
axis = [1, 0, 0]
[joint.link]
mass_kg = 0.5
centre_of_mass_m = [0, 0.1, 0.05]
)" + more;
}

void accept(const std::string& more) {
  static_cast<void>(parse_robot(two_joints(more), "wrist.toml"));
}

std::string transmission_refusal(const std::string& more) {
  return message_of<InputError>([&] { accept(more); });
}

TEST(TransmissionTable, HasOneNumberPerJointOrAMatrix) {
  const RobotDescription geared =
      parse_robot(two_joints("[transmission]\nratio = [100, -80]\noffset_rad = [0.5, 0]\n"
                             "torque_constant = [0.05, 0.06]\nsource = 'data sheet'\n"),
                  "wrist.toml");
  const Eigen::Matrix2d diagonal = desk::motor_per_joint(*geared.transmission);
  EXPECT_EQ(diagonal, (Eigen::Matrix2d() << 100, 0, 0, -80).finished());
  EXPECT_EQ(desk::motor_offset_rad(*geared.transmission), Eigen::Vector2d(0.5, 0));
  EXPECT_THAT(desk::coupled_groups(*geared.transmission), ElementsAre(0, 1));
  const RobotDescription wrist =
      parse_robot(two_joints("[transmission]\nmatrix = [[50, 50], [50, -50]]\n"), "wrist.toml");
  EXPECT_EQ(desk::motor_per_joint(*wrist.transmission),
            (Eigen::Matrix2d() << 50, 50, 50, -50).finished());
  EXPECT_THAT(desk::coupled_groups(*wrist.transmission), ElementsAre(0, 0));
}

TEST(TransmissionTable, GroupsAreWhatMovesTogether) {
  desk::TransmissionSettings settings;
  settings.matrix = {{0, 3, 0, 0}, {2, 0, 0, 0}, {0, 0, 5, 0}, {0, 0, 1, 4}};
  EXPECT_THAT(desk::coupled_groups(settings), ElementsAre(0, 0, 2, 2));
}

TEST(TransmissionTable, DamagedOnesSayWhatIsWrongAndHowToMendIt) {
  EXPECT_THAT(transmission_refusal("[transmission]\n"),
              AllOf(HasSubstr("line 18, transmission"), HasSubstr("neither ratio nor matrix")));
  EXPECT_THAT(transmission_refusal("[transmission]\nratio = [1, 1]\nmatrix = [[1, 0], [0, 1]]\n"),
              AllOf(HasSubstr("transmission.matrix"), HasSubstr("a matrix beside ratio")));
  EXPECT_THAT(transmission_refusal("[transmission]\nratio = [100]\n"),
              AllOf(HasSubstr("transmission.ratio"), HasSubstr("a list of 2 numbers")));
  EXPECT_THAT(transmission_refusal("[transmission]\nratio = [100, 0]\n"),
              AllOf(HasSubstr("transmission.ratio"), HasSubstr("0 for joint 2")));
  EXPECT_THAT(transmission_refusal("[transmission]\nratio = [100, -1e-7]\n"),
              AllOf(HasSubstr("transmission.ratio"), HasSubstr("-1e-07 for joint 2"),
                    HasSubstr("1e-06 or more in size")));
  EXPECT_THAT(transmission_refusal("[transmission]\nratio = [100, 'fast']\n"),
              HasSubstr("transmission.ratio[2]"));
  EXPECT_THAT(transmission_refusal("[transmission]\nratio = [100, 1e9]\n"),
              HasSubstr("transmission.ratio[2]"));
  EXPECT_THAT(transmission_refusal("[transmission]\nratio = [100, nan]\n"),
              HasSubstr("transmission.ratio[2]"));
  EXPECT_THAT(transmission_refusal("[transmission]\nmatrix = [[1, 2]]\n"),
              AllOf(HasSubstr("transmission.matrix"), HasSubstr("2 rows of 2 numbers")));
  EXPECT_THAT(transmission_refusal("[transmission]\nmatrix = [[1, 2], [3]]\n"),
              HasSubstr("transmission.matrix[2]"));
  EXPECT_THAT(transmission_refusal("[transmission]\nratio = [1, 1]\ntorque_constant = [0.1, 0]\n"),
              AllOf(HasSubstr("transmission.torque_constant"), HasSubstr("0 for motor 2")));
  EXPECT_THAT(
      transmission_refusal("[transmission]\nratio = [1, 1]\ntorque_constants = [1, 1]\n"),
      AllOf(HasSubstr("transmission.torque_constants"), HasSubstr("write `torque_constant`")));
  EXPECT_THAT(transmission_refusal("[transmission]\nratio = [1, 1]\noffset_rad = [0]\n"),
              HasSubstr("transmission.offset_rad"));
  EXPECT_THAT(transmission_refusal("[[transmission]]\nratio = [1, 1]\n"), HasSubstr("a table"));
}

TEST(TransmissionTable, AMatrixWithoutAnInverseIsRefused) {
  EXPECT_THAT(transmission_refusal("[transmission]\nmatrix = [[50, 25], [100, 50]]\n"),
              AllOf(HasSubstr("line 19, transmission.matrix"), HasSubstr("singular")));
  EXPECT_THAT(transmission_refusal("[transmission]\nmatrix = [[0, 0], [100, 50]]\n"),
              HasSubstr("motor 1 moving no joint"));
  EXPECT_THAT(transmission_refusal("[transmission]\nmatrix = [[0, 5], [0, 50]]\n"),
              HasSubstr("joint 1 moved by no motor"));
  // Ratios of a screw, rad/m, beside those of a gear, rad/rad, are no reason.
  EXPECT_NO_THROW(accept("[transmission]\nmatrix = [[1e5, 1e-1], [1e5, -1e-1]]\n"));
}

TEST(TransmissionTable, ChannelsOfMotorsNeedIt) {
  const std::string channels = "[channels]\nmotor_position = ['a', 'b']\ntorque = ['c', 'd']\n";
  EXPECT_THAT(transmission_refusal(channels),
              AllOf(HasSubstr("channels.motor_position"), HasSubstr("no [transmission]")));
  const std::string geared = "[transmission]\nratio = [100, 80]\n";
  EXPECT_NO_THROW(accept(geared + channels));
  const std::string currents = "[channels]\nposition = ['a', 'b']\nmotor_current = ['c', 'd']\n";
  EXPECT_THAT(transmission_refusal(geared + currents),
              AllOf(HasSubstr("channels.motor_current"), HasSubstr("add torque_constant")));
}

TEST(TransmissionTable, JointsThatShareMotorsAreMeasuredOnOneSide) {
  const std::string mixed =
      "[channels]\nposition = ['a', '']\nmotor_position = ['', 'b']\ntorque = ['c', 'd']\n";
  EXPECT_NO_THROW(accept("[transmission]\nratio = [100, 80]\n" + mixed));
  EXPECT_THAT(transmission_refusal("[transmission]\nmatrix = [[50, 50], [50, -50]]\n" + mixed),
              AllOf(HasSubstr("motor_position of joint 2 beside position of joint 1"),
                    HasSubstr("one side for joints that share motors")));
}

TEST(TransmissionTable, DrivesOfSingleAxesCannotMoveJointsThatShareMotors) {
  const std::string drives =
      "[drives]\nprotocol = 'can_simple'\nnode = [1, 2]\njoint_per_turn = [0.06, 0.07]\n";
  EXPECT_NO_THROW(accept("[transmission]\nratio = [100, 80]\n" + drives));
  const std::string wrist = "[transmission]\nmatrix = [[50, 50], [50, -50]]\n";
  EXPECT_THAT(transmission_refusal(wrist + drives),
              AllOf(HasSubstr("drives"), HasSubstr("joints 1 and 2 that share motors")));
  EXPECT_NO_THROW(accept(wrist + "[drives]\nprotocol = 'protected'\n"));
}

TEST(ChannelSides, EveryJointIsInOneOfTheLists) {
  const std::string geared = "[transmission]\nratio = [100, 80]\n[channels]\n";
  EXPECT_THAT(transmission_refusal(geared + "position = ['a', 'e']\nmotor_position = ['', 'b']\n"
                                            "torque = ['c', 'd']\n"),
              AllOf(HasSubstr("channels.motor_position[2]"),
                    HasSubstr("a channel beside channels.position[2]")));
  EXPECT_THAT(transmission_refusal(geared + "motor_position = ['', 'b']\ntorque = ['c', 'd']\n"),
              AllOf(HasSubstr("channels.position"), HasSubstr("nothing for joint 1")));
  EXPECT_THAT(transmission_refusal(geared + "motor_position = [{source = 'a', unit = 'mm'}, 'b']\n"
                                            "torque = ['c', 'd']\n"),
              AllOf(HasSubstr("channels.motor_position[1]"), HasSubstr("rad, mrad, deg, turns")));
  EXPECT_THAT(transmission_refusal("[channels]\nposition = ['a', 'b']\nat_rest = true\n"
                                   "motor_velocity = ['a', 'b']\ntorque = ['c', 'd']\n"),
              HasSubstr("channels.motor_velocity"));
}

TEST(ChannelSides, ASensorStandsAloneOrBesideTheDrive) {
  const RobotDescription robot = parse_robot(
      two_joints("[transmission]\nratio = [100, 80]\n[channels]\nposition = ['a', 'b']\n"
                 "motor_torque = ['c', '']\nsensor_torque = ['s', 'r']\n"),
      "wrist.toml");
  const desk::ChannelMap& map = *robot.channels;
  EXPECT_THAT(map.torque_of, ElementsAre(ChannelOf::kMotor, ChannelOf::kSensor));
  EXPECT_EQ(map.torque[1].source, "r");
  ASSERT_EQ(map.sensor_torque.size(), 2U);
  EXPECT_EQ(map.sensor_torque[0]->source, "s");
  EXPECT_FALSE(map.sensor_torque[1].has_value());
}

TEST(EffectsOfMotors, NeedATransmissionAndAnActionOfTheShaft) {
  const std::string geared = "[transmission]\nmatrix = [[50, 50], [50, -50]]\n";
  const auto effect = [](const std::string& kind, const std::string& rest) {
    return "[[effect]]\nkind = '" + kind + "'\n" + rest;
  };
  const RobotDescription robot = parse_robot(
      two_joints(geared + effect("viscous_friction", "motor = 2\ncoefficient = 1e-4\n")),
      "wrist.toml");
  EXPECT_TRUE(robot.effects[0].of_motor);
  EXPECT_EQ(robot.effects[0].joint, 1);
  EXPECT_THAT(transmission_refusal(effect("viscous_friction", "motor = 2\ncoefficient = 1\n")),
              AllOf(HasSubstr("effect[1].motor"), HasSubstr("without [transmission]")));
  EXPECT_THAT(transmission_refusal(
                  geared + effect("viscous_friction", "motor = 2\njoint = 1\ncoefficient = 1\n")),
              HasSubstr("a motor beside a joint"));
  EXPECT_THAT(
      transmission_refusal(geared + effect("viscous_friction", "motor = 3\ncoefficient = 1\n")),
      HasSubstr("effect[1].motor"));
  for (const char* rest :
       {"torque_scale'\nmotor = 1\nerror = 0.1\n", "tip_payload'\nmotor = 1\nmass = 0.1\n",
        "time_delay'\nmotor = 1\ndelay = 0.001\n",
        "hysteresis'\nmotor = 1\nlevel = 0.1\nwidth = 0.01\n",
        "joint_coupling'\nmotor = 1\ncoefficient = 1\nlevel = 0\nsource_joint = 2\n"}) {
    EXPECT_THAT(transmission_refusal(geared + "[[effect]]\nkind = '" + rest),
                AllOf(HasSubstr("effect[1].motor"), HasSubstr("write `joint`")))
        << rest;
  }
}

}  // namespace
}  // namespace offnominal::test
