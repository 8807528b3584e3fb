#include "log/joint_side.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>

#include "common/error.hpp"
#include "common/number.hpp"
#include "desk/support/temporary_file.hpp"
#include "log/read_log.hpp"
#include "robot/robot_file.hpp"
#include "support/recordings.hpp"

// What motors do becomes what joints do: worked by hand for two motors that drive a pitch and a
// roll, q_m1 = 40 pitch + 20 roll, q_m2 = 40 pitch - 20 roll, hence tau_pitch = 40 (tau_m1 +
// tau_m2), tau_roll = 20 (tau_m1 - tau_m2).

namespace offnominal::test {
namespace {

using desk::InputError;
using desk::Log;
using desk::RobotDescription;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr int kSamples = 400;
constexpr double kPeriodS = 0.005;

double pitch(double t) { return 0.3 * std::sin(2 * t); }
double roll(double t) { return 0.2 * std::sin(3 * t); }
double pitch_velocity(double t) { return 0.6 * std::cos(2 * t); }
double roll_velocity(double t) { return 0.6 * std::cos(3 * t); }

std::string robot_text(const std::string& more) {
  std::string text = "format = 1\nname = 'wrist'\ngravity_m_s2 = [0, 0, -9.81]\n";
  for (const char* name : {"pitch", "roll"}) {
    text += std::string("[[joint]]\nname = '") + name +
            "'\ntype = 'revolute'\naxis = [0, 1, 0]\n"
            "[joint.link]\nmass_kg = 1\ncentre_of_mass_m = [0.1, 0, 0]\n";
  }
  return text + more;
}

constexpr const char* kWrist =
    "[transmission]\nmatrix = [[40, 20], [40, -20]]\noffset_rad = [0.5, -1]\n"
    "torque_constant = [0.05, -0.04]\n";

// Columns of motors: a1, a2 positions in deg; v1, v2 in rpm; c1, c2 currents in mA: motor 1 gives
// 0.1 N m and motor 2 0.06 N m throughout. s1, s2: of the joints.
std::string wrist_csv() {
  std::string text = "t,a1,a2,v1,v2,c1,c2,q1,q2,s1,s2\n";
  constexpr double kDeg = 180 / std::numbers::pi;
  constexpr double kRpm = 30 / std::numbers::pi;
  for (int i = 0; i < kSamples; ++i) {
    const double t = kPeriodS * i;
    const double values[]{t,
                          (40 * pitch(t) + 20 * roll(t) + 0.5) * kDeg,
                          (40 * pitch(t) - 20 * roll(t) - 1) * kDeg,
                          (40 * pitch_velocity(t) + 20 * roll_velocity(t)) * kRpm,
                          (40 * pitch_velocity(t) - 20 * roll_velocity(t)) * kRpm,
                          2000,
                          -1500,
                          pitch(t),
                          roll(t),
                          6 + t,
                          0.7};
    for (const double value : values) text += desk::shortest(value) + ",";
    text.back() = '\n';
  }
  return text;
}

Log read(const std::string& more, const std::string& csv = wrist_csv()) {
  const RobotDescription robot = desk::parse_robot(robot_text(more), "wrist.toml");
  const TemporaryFile file("log.csv", csv);
  return desk::read_log(file.path(), robot);
}

constexpr const char* kMotorChannels =
    "[channels]\nmotor_position = [{source = 'a1', unit = 'deg'}, {source = 'a2', unit = 'deg'}]\n"
    "motor_velocity = [{source = 'v1', unit = 'rpm'}, {source = 'v2', unit = 'rpm'}]\n"
    "motor_current = [{source = 'c1', unit = 'mA'}, {source = 'c2', unit = 'mA'}]\n";

TEST(JointSide, ACoupledWristIsWorkedOutAsByHand) {
  const Log log = read(std::string(kWrist) + kMotorChannels);
  ASSERT_EQ(log.sample_count(), kSamples);
  for (Eigen::Index i = 0; i < kSamples; ++i) {
    const double t = kPeriodS * static_cast<double>(i);
    ASSERT_NEAR(log.q(i, 0), pitch(t), 1e-12);
    ASSERT_NEAR(log.q(i, 1), roll(t), 1e-12);
    ASSERT_NEAR(log.dq(i, 0), pitch_velocity(t), 1e-12);
    ASSERT_NEAR(log.dq(i, 1), roll_velocity(t), 1e-12);
    ASSERT_NEAR(log.tau(i, 0), 40 * (0.1 + 0.06), 1e-12);
    ASSERT_NEAR(log.tau(i, 1), 20 * (0.1 - 0.06), 1e-12);
  }
  EXPECT_FALSE(log.dq_derived[0]);
}

TEST(JointSide, ThePowerOfTheMotorsIsThatOfTheJoints) {
  const Log log = read(std::string(kWrist) + kMotorChannels);
  for (Eigen::Index i = 0; i < kSamples; i += 7) {
    const double t = kPeriodS * static_cast<double>(i);
    const double motors = 0.1 * (40 * pitch_velocity(t) + 20 * roll_velocity(t)) +
                          0.06 * (40 * pitch_velocity(t) - 20 * roll_velocity(t));
    EXPECT_NEAR(log.tau.row(i).dot(log.dq.row(i)), motors, 1e-11);
  }
}

TEST(JointSide, EachQuantityHasASideOfItsOwn) {
  const Log log =
      read(std::string(kWrist) +
           "[channels]\nposition = ['q1', 'q2']\nmotor_torque = [{source = 'c1', scale = "
           "5e-5}, {source = 'c2', scale = -4e-5}]\n");
  EXPECT_NEAR(log.q(100, 0), pitch(0.5), 1e-12);
  EXPECT_NEAR(log.tau(100, 0), 6.4, 1e-12);
  EXPECT_NEAR(log.tau(100, 1), 0.8, 1e-12);
}

TEST(JointSide, RatiosWithASignTurnPositionsAndTorques) {
  const Log log = read(
      "[transmission]\nratio = [100, -50]\n[channels]\nposition = ['q1', '']\n"
      "motor_position = ['', {source = 'a2', unit = 'deg'}]\nmotor_torque = ['', 's1']\n"
      "torque = ['s2', '']\n");
  const double t = 0.25;
  EXPECT_NEAR(log.q(50, 0), pitch(t), 1e-12);
  EXPECT_NEAR(log.q(50, 1), (40 * pitch(t) - 20 * roll(t) - 1) / -50, 1e-12);
  EXPECT_NEAR(log.tau(50, 0), 0.7, 1e-12);
  EXPECT_NEAR(log.tau(50, 1), -50 * (6 + t), 1e-12);
}

TEST(JointSide, AVelocityNeedsAllMotorsThatMoveTheJoint) {
  const Log log =
      read(std::string(kWrist) +
           "[channels]\nmotor_position = [{source = 'a1', unit = 'deg'}, {source = 'a2', unit = "
           "'deg'}]\n"
           "motor_velocity = ['', {source = 'v2', unit = 'rpm'}]\ntorque = ['s1', 's2']\n");
  EXPECT_TRUE(log.dq_derived[0]);
  EXPECT_TRUE(log.dq_derived[1]);
  EXPECT_NEAR(log.dq(200, 0), pitch_velocity(1), 1e-3);
  EXPECT_NEAR(log.dq(200, 1), roll_velocity(1), 1e-3);
  EXPECT_THAT(log.remarks, Contains(AllOf(HasSubstr("velocity of joint 2 is derived"),
                                          HasSubstr("motor 1, which moves with it, has none"))));
}

TEST(JointSide, AMotorsPositionIsUnfoldedBeforeItIsGearedDown) {
  std::string csv = "t,a1,q2,s1,s2\n";
  for (int i = 0; i < kSamples; ++i) {
    const double t = kPeriodS * i;
    const double turns = std::fmod(50 * (0.4 * t), 2 * std::numbers::pi);
    for (const double value : {t, turns, roll(t), 1 + t}) csv += desk::shortest(value) + ",";
    csv += "2\n";
  }
  const Log log = read(
      "[transmission]\nratio = [50, 1]\n[channels]\nmotor_position = ['a1', '']\n"
      "position = ['', 'q2']\ntorque = ['s1', 's2']\n",
      csv);
  EXPECT_NEAR(log.q(kSamples - 1, 0), 0.4 * kPeriodS * (kSamples - 1), 1e-9);
  EXPECT_THAT(log.remarks, Contains(HasSubstr("the position of motor 1 is folded into a turn")));
}

TEST(JointSide, HoldMapsAreTurnedTooAndTheirApproachIsTheJoints) {
  std::string csv = "a1,i1,q2,s2\n";
  for (int i = 0; i < 240; ++i) {
    csv += std::to_string(0.1 * i) + "," + std::to_string(i % 5) + "," + std::to_string(0.01 * i) +
           ",1\n";
  }
  const std::string more =
      "[transmission]\nratio = [-10, 1]\ntorque_constant = [0.5, 1]\n[channels]\nat_rest = true\n"
      "motor_position = ['a1', '']\nposition = ['', 'q2']\nmotor_current = ['i1', '']\n"
      "torque = ['', 's2']\n";
  const RobotDescription robot = desk::parse_robot(robot_text(more), "wrist.toml");
  const TemporaryFile file("map.csv", csv);
  const Log log = desk::read_log_or_hold_map(file.path(), robot, {});
  EXPECT_NEAR(log.q(200, 0), -2, 1e-12);
  EXPECT_NEAR(log.tau(204, 0), -10 * 0.5 * 4, 1e-12);
  EXPECT_EQ(log.approach(200, 0), -1);
  EXPECT_EQ(log.approach(200, 1), 1);
}

TEST(JointSide, ASensorBesideTheDriveIsKeptApart) {
  const Log log =
      read(std::string(kWrist) +
           "[channels]\nposition = ['q1', 'q2']\nmotor_current = [{source = 'c1', unit = "
           "'mA'}, {source = 'c2', unit = 'mA'}]\nsensor_torque = ['s1', '']\n");
  ASSERT_TRUE(log.has_both(0));
  EXPECT_FALSE(log.has_both(1));
  EXPECT_FALSE(log.of_sensor(0));
  EXPECT_NEAR(log.tau(100, 0), 6.4, 1e-12);
  EXPECT_NEAR(log.sensor_tau(100, 0), 6.5, 1e-12);
  const Log alone = read("[channels]\nposition = ['q1', 'q2']\nsensor_torque = ['s1', 's2']\n");
  EXPECT_TRUE(alone.of_sensor(1));
  EXPECT_NEAR(alone.tau(100, 1), 0.7, 1e-12);
  EXPECT_EQ(alone.sensor_tau.rows(), 0);
}

TEST(JointSide, ChannelsOfACommandLineAreCheckedAgainstTheRobot) {
  const RobotDescription robot = desk::parse_robot(robot_text(""), "wrist.toml");
  const TemporaryFile file("log.csv", wrist_csv());
  const TemporaryFile channels("channels.toml", kMotorChannels);
  EXPECT_THAT(message_of<InputError>([&] {
                desk::read_log(file.path(), robot, {channels.path(), std::nullopt});
              }),
              AllOf(HasSubstr("channels.toml"), HasSubstr("no [transmission]")));
}

// Angles "seen at the joint" by the motors' encoders, torques of the motors, its own gear ratios.
TEST(JointSide, AnIndustrialArmsTorquesAreThoseOfItsMotorsTimesTheGears) {
  const auto file = recordings_dir() / "kuka_kr300" / "B.mat";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recording at " << file;
  constexpr double kRatio[]{256.857142857143, -267.428571428571};
  std::string channels = "[channels]\ntime = 'rec.time_cont'\n";
  std::string position;
  std::string torque;
  for (const char* axis : {"1", "2"}) {
    position += std::string("{source = 'rec.act_pos_mot_deg(") + axis + ",:)', unit = 'deg'},";
    torque += std::string("'rec.act_torque_abs_nm(") + axis + ",:)',";
  }
  const auto list = [](const char* key, const std::string& entries) {
    return std::string(key) + " = [" + entries + "]\n";
  };
  const auto read_with = [&](const std::string& more) {
    const RobotDescription robot = desk::parse_robot(robot_text(more), "kr300.toml");
    return desk::read_log(file, robot);
  };
  const Log geared =
      read_with("[transmission]\nratio = [256.857142857143, -267.428571428571]\n" + channels +
                list("position", position) + list("motor_torque", torque));
  const Log plain = read_with(channels + list("position", position) + list("torque", torque));
  ASSERT_EQ(geared.sample_count(), 2501);
  EXPECT_EQ(geared.q, plain.q);
  for (Eigen::Index joint = 0; joint < 2; ++joint) {
    const Eigen::VectorXd expected = kRatio[joint] * plain.tau.col(joint);
    EXPECT_LT((geared.tau.col(joint) - expected).norm(), 1e-12 * expected.norm());
  }
}

}  // namespace
}  // namespace offnominal::test
