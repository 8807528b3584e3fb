#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "common/error.hpp"
#include "desk/support/temporary_folder.hpp"
#include "log/read_log.hpp"
#include "look/look.hpp"
#include "look/look_report.hpp"
#include "robot/channels.hpp"
#include "robot/robot_file.hpp"
#include "support/places.hpp"

// What look proposes where names or units alone do not tell, and what it shows of channels that a
// robot file has.

namespace offnominal::test::look_proposal {
namespace {

using offnominal::desk::InputError;
using offnominal::desk::Log;
using offnominal::desk::Look;
using offnominal::desk::look_at;
using offnominal::desk::parse_robot;
using offnominal::desk::read_log;
using offnominal::desk::RobotDescription;
using offnominal::test::put;
using offnominal::test::TemporaryFolder;
using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr int kSamples = 1000;
constexpr double kPeriodS = 0.01;
constexpr double kDegrees = 180 / std::numbers::pi;

double position(int joint, double t) { return joint == 0 ? std::sin(2 * t) : std::cos(3 * t); }
double velocity(int joint, double t) {
  return joint == 0 ? 2 * std::cos(2 * t) : -3 * std::sin(3 * t);
}
double torque(int joint, double t) { return std::sin((5 + joint) * t) + 0.3; }

struct Scale {
  double q = 1;
  double dq = 1;
  double tau = 1;
};

// Time, the joints' positions, their velocities, their torques.
std::string rows(int joints, const Scale& scale = {}, int first = 0, int samples = kSamples) {
  std::string text;
  const auto number = [&](double value) { text += "," + std::to_string(value); };
  for (int i = first; i < samples; ++i) {
    const double t = kPeriodS * i;
    text += std::to_string(t);
    for (int k = 0; k < joints; ++k) number(scale.q * position(k, t));
    for (int k = 0; k < joints; ++k) number(scale.dq * velocity(k, t));
    for (int k = 0; k < joints; ++k) number(scale.tau * torque(k, t));
    text += "\n";
  }
  return text;
}

std::string joint_text(const std::string& name) {
  return "[[joint]]\nname = \"" + name +
         "\"\ntype = \"revolute\"\naxis = [0.0, 0.0, 1.0]\n[joint.link]\nmass_kg = 1.0\n"
         "centre_of_mass_m = [0.3, 0.0, 0.0]\n[joint.limits]\nposition = [-3.0, 3.0]\n";
}

std::string robot_text(std::initializer_list<const char*> joints, const std::string& more = "") {
  std::string text = "format = 1\nname = \"r\"\ngravity_m_s2 = [0.0, 0.0, -9.81]\n";
  for (const char* joint : joints) text += joint_text(joint);
  return text + more;
}

class LookProposal : public testing::Test {
 protected:
  Look look(const std::string& content, const std::optional<std::string>& robot = {}) {
    put(folder_ / "a.csv", content);
    if (robot) robot_ = parse_robot(*robot, "r.toml");
    return look_at(folder_ / "a.csv", robot ? &*robot_ : nullptr, std::nullopt);
  }
  // As whoever pastes what is proposed behind a robot file.
  Log pasted(const Look& look, const std::string& robot) {
    return read_log(folder_ / "a.csv", parse_robot(robot + channels_text(look), "pasted.toml"));
  }
  static void expect_motion(const Log& log, double tolerance = 1e-4) {
    ASSERT_EQ(log.sample_count(), kSamples);
    for (int k = 0; k < log.joint_count(); ++k) {
      for (int i = 0; i < kSamples; i += 37) {
        EXPECT_NEAR(log.q(i, k), position(k, kPeriodS * i), tolerance);
        EXPECT_NEAR(log.dq(i, k), velocity(k, kPeriodS * i), tolerance);
      }
    }
  }

  TemporaryFolder folder_;
  std::optional<RobotDescription> robot_;
};

TEST_F(LookProposal, CurrentsAreRefusedUntilTheirTorqueConstantsAreSaid) {
  const std::string robot = robot_text({"a"});
  const Look seen = look("t,pos,vel,i_mA\n" + rows(1), robot);
  const std::string text = channels_text(seen);
  EXPECT_THAT(text, HasSubstr("motor_current = [{source = \"i_mA\", unit = \"mA\"}]"));
  EXPECT_THAT(text, HasSubstr("# torque_constant = [...]"));
  EXPECT_THAT(seen.missing, Contains(HasSubstr("torque constants")));
  EXPECT_THROW(pasted(seen, robot), InputError);
  const std::string gear = "[transmission]\nratio = [2.0]\n";
  EXPECT_THROW(pasted(seen, robot + gear), InputError);
  const Log log = pasted(seen, robot + gear + "torque_constant = [10.0]\n");
  EXPECT_NEAR(log.tau(100, 0), 0.02 * torque(0, 1), 1e-6);
  // A robot file that says them leaves nothing to say.
  const Look known =
      look("t,pos,vel,i_mA\n" + rows(1), robot + gear + "torque_constant = [10.0]\n");
  EXPECT_THAT(known.missing, IsEmpty());
}

TEST_F(LookProposal, VoltagesNeedAScale) {
  const std::string robot = robot_text({"a"});
  const Look seen = look("t,pos,vel,vir\n" + rows(1), robot);
  EXPECT_THAT(channels_text(seen), HasSubstr("unit = \"V\""));
  EXPECT_THROW(pasted(seen, robot), InputError);
}

TEST_F(LookProposal, ColumnsOfAnotherNumberThanTheJointsAreNamed) {
  const Look three = look("t,q1,q2,q3,i1\n0,1,2,3,4\n0.1,1,2,3,4\n", robot_text({"a", "b"}));
  EXPECT_THAT(three.missing,
              Contains("positions, one for each of 2 joints, told by their names: q1, q2, q3 are "
                       "3; name those of the joints"));
  EXPECT_THAT(three.missing, Contains(HasSubstr("told by their names: i1 is one; name those")));
}

TEST_F(LookProposal, WhatIsCalledAMotorsIsReadAsAMotors) {
  const Look seen = look("t,motor_pos,motor_vel,motor_torque\n" + rows(1), robot_text({"a"}));
  EXPECT_THAT(channels_text(seen), HasSubstr("motor_position = "));
  EXPECT_THAT(channels_text(seen), HasSubstr("motor_velocity = "));
  EXPECT_THAT(channels_text(seen), HasSubstr("motor_torque = "));
  EXPECT_THAT(channels_text(seen), HasSubstr("# ratio = [...]"));
  EXPECT_THROW(pasted(seen, robot_text({"a"})), InputError);
}

// As libfranka writes its log (logToCSV), of two joints; its time is in ms.
TEST_F(LookProposal, OfALogOfLibfrankaTheMeasuredColumnsAreTaken) {
  std::string log =
      "time, success_rate, state.q_d[0], state.q_d[1],state.q[0], state.q[1],state.dq[0], "
      "state.dq[1],state.dq_d[0], state.dq_d[1],state.tau_J[0], "
      "state.tau_J[1],state.tau_ext_hat_filtered[0], state.tau_ext_hat_filtered[1],cmd.tau_J_d[0], "
      "cmd.tau_J_d[1]\n";
  for (int i = 0; i < kSamples; ++i) {
    const double t = 0.001 * i;
    const auto both = [&](double (*of)(int, double), double scale) {
      return "," + std::to_string(scale * of(0, t)) + "," + std::to_string(scale * of(1, t));
    };
    log += std::to_string(i) + ",1" + both(position, 1.01) + both(position, 1) + both(velocity, 1) +
           both(velocity, 1.01) + both(torque, 1) + both(torque, 0.1) + both(torque, 0.9) + "\n";
  }
  const Look seen = look(log, robot_text({"panda_joint1", "panda_joint2"}));
  EXPECT_THAT(seen.missing, IsEmpty());
  EXPECT_THAT(channels_text(seen), HasSubstr(R"(time = {source = "time", unit = "ms"})"));
  EXPECT_EQ(seen.channels.position[1].source, "state.q[1]");
  EXPECT_EQ(seen.channels.velocity[1]->source, "state.dq[1]");
  EXPECT_EQ(seen.channels.torque[1].source, "state.tau_J[1]");
  EXPECT_THAT(seen.notes, Contains(HasSubstr("state.q_d[#], state.dq_d[#], "
                                             "state.tau_ext_hat_filtered[#], cmd.tau_J_d[#]")));
}

// The same with what it has beside: a pose, the commands, and too few rows to judge a velocity.
TEST_F(LookProposal, TheSampleOfLibfrankaNeedsNothingSaid) {
  const Look seen =
      look_at(test::source_dir() / "tests" / "fuzz" / "corpus" / "csv" / "libfranka.csv", nullptr,
              std::nullopt);
  EXPECT_THAT(seen.missing, IsEmpty());
  EXPECT_EQ(seen.channels.time.source, "time");
  EXPECT_EQ(seen.channels.position[0].source, "state.q[0]");
  EXPECT_EQ(seen.channels.torque[1].source, "state.tau_J[1]");
}

TEST_F(LookProposal, NamesOfJointsStandInTheRobotsOrder) {
  const std::string robot = robot_text({"shoulder_pan_joint", "elbow_joint"});
  const Look seen = look(
      "time,position.elbow_joint,position.shoulder_pan_joint,"
      "velocity.elbow_joint,velocity.shoulder_pan_joint,effort.elbow_joint,"
      "effort.shoulder_pan_joint\n" +
          rows(2),
      robot);
  EXPECT_THAT(seen.missing, IsEmpty());
  EXPECT_THAT(seen.notes, Contains(HasSubstr("in the robot's order")));
  EXPECT_EQ(seen.channels.position[0].source, "position.shoulder_pan_joint");
  const Log log = pasted(seen, robot);
  EXPECT_NEAR(log.q(100, 0), position(1, 1), 1e-4);
  EXPECT_NEAR(log.tau(100, 1), torque(0, 1), 1e-4);
}

TEST_F(LookProposal, WithoutAHeaderNumbersTellTimePositionsAndVelocities) {
  for (const bool with_robot : {true, false}) {
    const std::string robot = robot_text({"a", "b"});
    const Look seen = look(rows(2), with_robot ? std::optional<std::string>(robot) : std::nullopt);
    const std::string text = channels_text(seen);
    EXPECT_THAT(text, HasSubstr("time = 1   # guessed"));
    EXPECT_THAT(text, HasSubstr("position = [2, 3]   # guessed"));
    EXPECT_THAT(text, HasSubstr("velocity = [4, 5]   # guessed"));
    EXPECT_THAT(text, HasSubstr("torque = [6, 7]   # guessed"));
    EXPECT_THAT(seen.notes, Contains(HasSubstr("columns go by their numbers")));
    expect_motion(pasted(seen, robot));
  }
}

// A time that has a name beside the matrix is the time.
TEST_F(LookProposal, ColumnsOfOneMatrixGoByTheTimeBesideThem) {
  std::string header = "t";
  for (int i = 1; i <= 6; ++i) header += fmt::format(",\"data(:,{})\"", i);
  const std::string robot = robot_text({"a", "b"});
  const Look seen = look(header + "\n" + rows(2), robot);
  EXPECT_EQ(seen.channels.time.source, "t");
  ASSERT_EQ(seen.channels.position.size(), 2U);
  EXPECT_EQ(seen.channels.position[0].source, "data(:,1)");
  expect_motion(pasted(seen, robot));
}

// Names that say what they are count, however many they are.
TEST_F(LookProposal, ColumnsOfOneMatrixThatIsCalledATorqueStayThat) {
  std::string header;
  for (int i = 1; i <= 7; ++i) header += fmt::format("{}\"tau(:,{})\"", i == 1 ? "" : ",", i);
  const Look seen = look(header + "\n" + rows(2), robot_text({"a", "b"}));
  EXPECT_FALSE(seen.guessed);
  EXPECT_THAT(seen.channels.position, IsEmpty());
}

// As of a .mat file that holds one matrix.
TEST_F(LookProposal, ColumnsOfOneMatrixGoByTheirNumbersToo) {
  std::string header;
  for (int i = 1; i <= 7; ++i) header += fmt::format("{}\"data(:,{})\"", i == 1 ? "" : ",", i);
  const std::string robot = robot_text({"a", "b"});
  const Look seen = look(header + "\n" + rows(2), robot);
  const std::string text = channels_text(seen);
  EXPECT_THAT(text, HasSubstr("time = {source = \"data(:,1)\"}   # guessed"));
  EXPECT_THAT(text, HasSubstr("position = [{source = \"data(:,2)\"}, {source = \"data(:,3)\"}]"));
  EXPECT_THAT(seen.notes, Contains(HasSubstr("columns of one matrix have no names")));
  expect_motion(pasted(seen, robot));
}

TEST_F(LookProposal, WithoutAHeaderDegreesAreTold) {
  const std::string robot = robot_text({"a", "b"});
  const Look seen = look(rows(2, {kDegrees, kDegrees}), robot);
  EXPECT_THAT(channels_text(seen), HasSubstr("position = [{source = 2, unit = \"deg\"}, "));
  expect_motion(pasted(seen, robot));
}

TEST_F(LookProposal, WhatNumbersDoNotTellIsLeftAndNeverNoToml) {
  const std::string robot = robot_text({"a", "b", "c"});
  const Look seen = look(rows(2), robot);
  EXPECT_THAT(seen.channels.position, IsEmpty());
  EXPECT_THAT(seen.notes, Contains(HasSubstr("the robot has 3 joints")));
  EXPECT_THAT(channels_text(seen), HasSubstr("# position = [...]"));
  EXPECT_THROW(pasted(seen, robot), InputError);
}

// Time, position, and two columns of what `third` and `fourth` give.
template <typename Third, typename Fourth>
std::string four_columns(const Third& third, const Fourth& fourth) {
  std::string text;
  for (int i = 0; i < kSamples; ++i) {
    const double t = kPeriodS * i;
    text += std::to_string(t) + "," + std::to_string(position(0, t)) + "," +
            std::to_string(third(t)) + "," + std::to_string(fourth(t)) + "\n";
  }
  return text;
}

// As of a joint whose torque is its viscous friction.
TEST_F(LookProposal, WithoutAHeaderTwoThatMayBeTheVelocityAreNeither) {
  const auto dq = [](double t) { return velocity(0, t); };
  const auto viscous = [](double t) { return 1.02 * velocity(0, t) + 0.01 * std::sin(40 * t); };
  for (const std::string& content : {four_columns(dq, viscous), four_columns(viscous, dq)}) {
    const Look seen = look(content);
    const std::string text = channels_text(seen);
    EXPECT_THAT(text, HasSubstr("position = [2]   # guessed"));
    EXPECT_THAT(text, Not(HasSubstr("\nvelocity")));
    EXPECT_THAT(text, Not(HasSubstr("\ntorque")));
    EXPECT_THAT(seen.notes, Contains(HasSubstr("which is the velocity")));
    EXPECT_THAT(text, HasSubstr("torque = [...] with the number of 1 of the columns 3, 4"));
    EXPECT_THROW(pasted(seen, robot_text({"a"})), InputError);
  }
}

TEST_F(LookProposal, WithoutAHeaderNothingIsTakenForATorqueThatIsKnownAlready) {
  const auto dq = [](double t) { return velocity(0, t); };
  struct Case {
    double (*column)(double t);
    const char* why;
  };
  for (const Case& one :
       {Case{[](double t) { return kDegrees * position(0, t); }, "has 3 as its derivative"},
        Case{[](double t) { return -4 * velocity(0, t) + 1; }, "is 3 times a factor"},
        Case{[](double t) { return -4 * position(0, t); }, "is the derivative of 3"},
        Case{[](double t) { return 0.3 * position(0, t); }, "is 2 times a factor"},
        Case{[](double) { return 0.0; }, "never changes"},
        Case{[](double t) { return 3 * t + 1; }, "ascends all the time"}}) {
    const Look seen = look(four_columns(dq, one.column));
    EXPECT_THAT(channels_text(seen), HasSubstr("velocity = [3]   # guessed")) << one.why;
    EXPECT_THAT(channels_text(seen), Not(HasSubstr("\ntorque"))) << one.why;
    EXPECT_THAT(seen.notes, Contains(HasSubstr(std::string("column 4 ") + one.why)));
    EXPECT_THAT(seen.missing, Contains(HasSubstr("torque = [4] says so")));
  }
}

TEST_F(LookProposal, DegreesAreOfPositionAndVelocityAndOfEveryJoint) {
  const std::string robot = robot_text({"a", "b"});
  const std::string header = "t,q1,q2,dq1,dq2,tau1,tau2\n";
  const Look seen = look(header + rows(2, {kDegrees, kDegrees}), robot);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(seen.channels.position[k].unit, "deg");
    EXPECT_EQ(seen.channels.velocity[k]->unit, "deg/s");
  }
  expect_motion(pasted(seen, robot));
  // A joint a little beyond its limit is not in degrees.
  const Look beyond = look(header + rows(2, {3.2, 3.2}), robot);
  EXPECT_EQ(beyond.channels.position[0].unit, "");
}

// Two joints, each with two tones: of one alone either goes with the other's derivative.
std::string rows_of_two_tones() {
  std::string text;
  for (int i = 0; i < kSamples; ++i) {
    const double t = kPeriodS * i;
    text += std::to_string(t);
    for (const int order : {0, 1}) {
      for (const int k : {1, 2}) {
        double sum = 0;
        for (const double w : {k * 1.0, k * 3.0}) {
          sum += order == 0 ? std::sin(w * t) / w : std::cos(w * t);
        }
        text += "," + std::to_string(sum);
      }
    }
    text += "," + std::to_string(torque(0, t)) + "," + std::to_string(torque(1, t)) + "\n";
  }
  return text;
}

TEST_F(LookProposal, TheDerivativeTellsVelocitiesFromPositionsWhateverTheirNames) {
  const std::string robot = robot_text({"a", "b"});
  struct Case {
    const char* header;
    const char* note;
  };
  for (const Case& one :
       {Case{"t,pos_a_1,pos_a_2,pos_b_1,pos_b_2,tau_1,tau_2",
             "pos_b_1, pos_b_2: velocities, since the data show them as the derivative of pos_a_1"},
        Case{"t,pos_m_1,pos_m_2,pos_1,pos_2,tau_1,tau_2",
             "pos_1, pos_2: velocities, since the data show them as the derivative of pos_m_1"},
        Case{"t,dq1,dq2,q1,q2,tau1,tau2",
             "q1, q2 as the derivative of dq1, dq2, whatever their names say"}}) {
    const Look seen = look(std::string(one.header) + "\n" + rows_of_two_tones(), robot);
    EXPECT_THAT(seen.notes, Contains(HasSubstr(one.note))) << one.header;
    EXPECT_THAT(seen.notes, Each(Not(HasSubstr("would do as well")))) << one.header;
    EXPECT_THAT(seen.notes, Contains(HasSubstr("their units agree"))) << one.header;
    EXPECT_EQ(to_json(seen).at("columns").at(1).at("taken_for"), "position");
    EXPECT_EQ(to_json(seen).at("columns").at(3).at("taken_for"), "velocity");
    EXPECT_NEAR(pasted(seen, robot).dq(0, 1), 2, 1e-4) << one.header;
  }
}

// The derivative of a sine is the sine again, but for a sign: then names are right.
TEST_F(LookProposal, ASignOfOneToneIsNoOtherQuantity) {
  std::string text = "t,q1,dq1,tau1\n";
  for (int i = 0; i < kSamples; ++i) {
    const double t = kPeriodS * i;
    text += std::to_string(t) + "," + std::to_string(std::sin(t)) + "," +
            std::to_string(-std::cos(t)) + ",1\n";
  }
  const Look seen = look(text, robot_text({"a"}));
  EXPECT_EQ(seen.channels.position[0].source, "q1");
  EXPECT_THAT(seen.notes, Contains(HasSubstr("their signs are opposed")));
}

TEST_F(LookProposal, AJointThatHardlyMovesTakesTheUnitOfTheOthers) {
  std::string text = "t,q1,q2,dq1,dq2,tau1,tau2\n";
  for (int i = 0; i < kSamples; ++i) {
    const double t = kPeriodS * i;
    for (const double value :
         {t, kDegrees * position(0, t), 1.5, kDegrees * velocity(0, t), 0.0, torque(0, t)}) {
      text += std::to_string(value) + ",";
    }
    text += std::to_string(torque(1, t)) + "\n";
  }
  const Look seen = look(text, robot_text({"a", "b"}));
  EXPECT_EQ(seen.channels.position[1].unit, "deg");
  EXPECT_EQ(seen.channels.velocity[1]->unit, "deg/s");
  EXPECT_THAT(seen.notes, Contains(HasSubstr("could not be judged, one of them never changes")));
  EXPECT_THAT(seen.notes, Contains(HasSubstr("in the unit of the other joints")));
}

TEST_F(LookProposal, AGapDoesNotHideWhatVelocitiesAre) {
  const Look seen = look("t,q1,dq1,tau1\n" + rows(1, {}, 0, 400) + rows(1, {}, 600), std::nullopt);
  EXPECT_THAT(seen.notes, Contains(HasSubstr("their units agree")));
  EXPECT_THAT(seen.notes, Each(Not(HasSubstr("nothing in common"))));
}

TEST_F(LookProposal, ShowsWhatTheRobotsOwnChannelsRead) {
  const std::string robot =
      robot_text({"a"},
                 "[transmission]\nratio = [-50.0]\ntorque_constant = [0.05]\n[channels]\n"
                 "motor_position = {source = \"motor_pos\", unit = \"deg\"}\n"
                 "motor_current = {source = \"i_mA\", unit = \"mA\"}\n");
  const Look seen =
      look("t,motor_pos,motor_vel,i_mA\n" + rows(1, {-50 * kDegrees, -50 * kDegrees, 1000}), robot);
  ASSERT_EQ(seen.by_robot.size(), 3U);
  EXPECT_THAT(seen.by_robot[0].from, HasSubstr("motor_position `motor_pos` (deg)"));
  EXPECT_NEAR(seen.by_robot[0].high, 1, 1e-3);
  EXPECT_NEAR(seen.by_robot[0].low, -1, 1e-3);
  EXPECT_EQ(seen.by_robot[1].from, "derived from the position");
  EXPECT_NEAR(seen.by_robot[2].low, -50 * 0.05 * 1.3, 1e-2);
  EXPECT_EQ(seen.by_robot[2].unit, "N m");
  // Proposed is what the file does not say, and nothing else.
  ASSERT_EQ(seen.to_add.size(), 1U);
  EXPECT_EQ(seen.to_add[0], "motor_velocity = [{source = \"motor_vel\", unit = \"deg/s\"}]");
  EXPECT_THAT(text_of(seen), HasSubstr("to add to the robot file's [channels]:\nmotor_velocity"));
  EXPECT_THAT(text_of(seen), Not(HasSubstr("still to be said")));
  EXPECT_EQ(to_json(seen).at("read_by_robot").size(), 3U);
}

TEST_F(LookProposal, ChannelsThatDoNotFitAreSaidAndOthersProposed) {
  const std::string robot =
      robot_text({"a"}, "[channels]\nposition = \"enc\"\ntorque = \"load\"\n");
  const Look seen = look("t,q1,dq1,tau1\n" + rows(1), robot);
  EXPECT_THAT(seen.by_robot, IsEmpty());
  EXPECT_THAT(seen.notes.front(), HasSubstr("do not read this recording"));
  EXPECT_EQ(seen.channels.position.size(), 1U);
}

TEST_F(LookProposal, ColumnsByNumberInTheRobotsChannelsAreRead) {
  const std::string robot =
      robot_text({"a"}, "[channels]\ntime = 1\nposition = 2\nvelocity = 3\ntorque = 4\n");
  EXPECT_EQ(look(rows(1), robot).by_robot.size(), 3U);
  const Look named = look("zeit,lage,rate,last\n" + rows(1), robot);
  EXPECT_EQ(named.by_robot.size(), 3U);
  EXPECT_THAT(text_of(named), HasSubstr("nothing to add"));
}

TEST_F(LookProposal, FilesOfOneRecordingAreJoined) {
  const std::string robot = robot_text({"a"});
  put(folder_ / "q.csv", "t,pos\n0,0\n");
  std::string q = "t,pos\n";
  std::string tau = "stamp,torque\n";
  for (int i = 0; i < kSamples; ++i) {
    const double t = kPeriodS * i;
    q += std::to_string(t) + "," + std::to_string(position(0, t)) + "\n";
    tau += std::to_string(t) + "," + std::to_string(torque(0, t)) + "\n";
  }
  put(folder_ / "q.csv", q);
  put(folder_ / "tau.csv", tau);
  const std::string both = (folder_ / "q.csv").string() + "+" + (folder_ / "tau.csv").string();
  const Look seen = look_at(both, nullptr, std::nullopt);
  EXPECT_THAT(seen.missing, IsEmpty());
  EXPECT_THAT(channels_text(seen), HasSubstr("time = [{source = \"t\"}, {source = \"stamp\"}]"));
  const Log log = read_log(both, parse_robot(robot + channels_text(seen), "pasted.toml"));
  EXPECT_NEAR(log.tau(100, 0), torque(0, 1), 1e-4);
  std::string in_ms = "stamp,torque\n";
  for (int i = 0; i < kSamples; ++i) {
    in_ms += fmt::format("{},{}\n", 1e3 * kPeriodS * i, torque(0, kPeriodS * i));
  }
  put(folder_ / "tau.csv", in_ms);
  const Look longer = look_at(both, nullptr, std::nullopt);
  EXPECT_THAT(longer.notes, Contains(HasSubstr("as one in ms does: taken so")));
  EXPECT_THAT(channels_text(longer),
              HasSubstr("time = [{source = \"t\"}, {source = \"stamp\", unit = \"ms\"}]"));
  ASSERT_TRUE(longer.t_s);
  EXPECT_EQ(longer.t_s->size(), kSamples);
  std::string stamped = "sec,nanosec,torque\n";
  for (int i = 0; i < kSamples; ++i) {
    stamped += fmt::format("{},{},{}\n", i / 100, 10'000'000 * (i % 100), torque(0, kPeriodS * i));
  }
  put(folder_ / "tau.csv", stamped);
  EXPECT_THAT(channels_text(look_at(both, nullptr, std::nullopt)),
              HasSubstr("time = [{source = \"t\"}, {sum = [{source = \"sec\"}, "));
  put(folder_ / "tau.csv", "load\n1\n2\n");
  EXPECT_THROW(static_cast<void>(look_at(both, nullptr, std::nullopt)), InputError);
}

// Seconds and the rest of a stamp, as ROS has it, in front of the rows.
std::string stamped_rows(double per_second, const std::string& words = {}) {
  std::string text;
  for (int i = 0; i < kSamples; ++i) {
    const double t = kPeriodS * i;
    text +=
        fmt::format("{},{:.0f},{}", 1'795'600'000 + i / 100, per_second * 0.01 * (i % 100), words);
    text += fmt::format("{},{},{}\n", position(0, t), velocity(0, t), torque(0, t));
  }
  return text;
}

TEST_F(LookProposal, SecondsAndTheRestOfEachInTwoColumnsAreOneTime) {
  struct Case {
    const char *seconds, *rest;
    const char* unit;
    double per_second;
  };
  for (const Case& one : {Case{"sec", "nanosec", "ns", 1e9},
                          Case{"header.stamp.sec", "header.stamp.nanosec", "ns", 1e9},
                          Case{"secs", "nsecs", "ns", 1e9}, Case{"stamp", "stamp_nsec", "ns", 1e9},
                          Case{"tv_sec", "tv_usec", "us", 1e6}, Case{"t_s", "t_ms", "ms", 1e3},
                          Case{"a", "b", "ns", 1e9}}) {
    const std::string robot = robot_text({"a"});
    const Look seen = look(
        fmt::format("{},{},q1,dq1,tau1\n", one.seconds, one.rest) + stamped_rows(one.per_second),
        robot);
    EXPECT_THAT(seen.missing, IsEmpty()) << one.rest;
    EXPECT_THAT(channels_text(seen),
                HasSubstr(fmt::format("time = {{sum = [{{source = \"{}\"}}, {{source = \"{}\", "
                                      "unit = \"{}\"}}]}}\n",
                                      one.seconds, one.rest, one.unit)));
    expect_motion(pasted(seen, robot));
  }
}

TEST_F(LookProposal, TwoColumnsThatAreNoStampAreNoTime) {
  // The second begins anew where no second begins.
  std::string text = "a,b,q1,dq1,tau1\n";
  for (int i = 0; i < kSamples; ++i) {
    text += fmt::format("{},{},0,0,0\n", i / 100, (i % 70) * 10'000'000);
  }
  EXPECT_THAT(look(text).missing, Contains(HasSubstr("a column of time")));
}

TEST_F(LookProposal, WhatRos2EchoesNeedsNothingSaid) {
  const std::string robot = robot_text({"a"});
  for (const char* words : {"base,shoulder,", ",shoulder,"}) {
    const Look seen = look(stamped_rows(1e9, words), robot);
    EXPECT_THAT(seen.missing, IsEmpty());
    const std::string text = channels_text(seen);
    EXPECT_THAT(text, HasSubstr("time = {sum = [1, {source = 2, unit = \"ns\"}]}   # guessed\n"));
    EXPECT_THAT(text, HasSubstr("position = [5]   # guessed\n"));
    expect_motion(pasted(seen, robot));
  }
}

TEST_F(LookProposal, OfTwoThatAreCalledVelocitiesTheDerivativeIsOne) {
  // To some "qd" is the velocity, to others what was desired. Of a single tone nothing tells.
  const auto q = [](double t) { return std::sin(2 * t) + 0.4 * std::sin(7 * t); };
  const auto dq = [](double t) { return 2 * std::cos(2 * t) + 2.8 * std::cos(7 * t); };
  std::string text = "t,q1,qd1,dq1,tau1\n";
  for (int i = 0; i < 1000; ++i) {
    const double t = kPeriodS * i;
    text += fmt::format("{},{},{},{},{}\n", t, q(t), q(t - 0.02), dq(t), 3 * q(t));
  }
  EXPECT_THAT(channels_text(look(text, robot_text({"a"}))),
              HasSubstr("velocity = [{source = \"dq1\"}]"));
}

TEST_F(LookProposal, BesideAPeriodTheTimeMayBeAnything) {
  std::string text = "t,q1,dq1,tau1\n";
  for (int i = 0; i < kSamples; ++i) {
    const double t = kPeriodS * i;
    text += "11/24/2026," + std::to_string(position(0, t)) + "," + std::to_string(velocity(0, t)) +
            "," + std::to_string(torque(0, t)) + "\n";
  }
  EXPECT_THROW(static_cast<void>(look(text)), InputError);
  const Look seen = look_at(folder_ / "a.csv", nullptr, kPeriodS);
  EXPECT_THAT(seen.missing, IsEmpty());
  EXPECT_THAT(channels_text(seen), HasSubstr("period_s = 0.01"));
}

TEST_F(LookProposal, TimeDoesNotRest) {
  // Of which fifty rows are less than a thousandth.
  std::string text = "t,q1,tau1\n";
  for (int i = 0; i < 60'000; ++i) text += std::to_string(i * 1e-3) + ",0,0\n";
  const Look seen = look(text);
  EXPECT_EQ(to_json(seen).at("columns").at(0).at("resting_share"), 0);
}

}  // namespace
}  // namespace offnominal::test::look_proposal
