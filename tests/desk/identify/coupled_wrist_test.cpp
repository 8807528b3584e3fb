#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>

#include "common/error.hpp"
#include "common/number.hpp"
#include "compare/compare.hpp"
#include "compare/inverse_model.hpp"
#include "desk/support/temporary_file.hpp"
#include "desk/support/temporary_folder.hpp"
#include "identify/add.hpp"
#include "log/read_log.hpp"
#include "robot/robot_file.hpp"
#include "support/repetitions.hpp"
#include "support/seed.hpp"

// Two motors that move a pitch and a roll together, as MuJoCo has it: the motors' angles are the
// lengths of tendons over both joints, and once more bodies of their own, held to the joints by
// equality constraints.

namespace offnominal::test {
namespace {

using desk::Log;
using desk::Motion;
using desk::RobotDescription;
using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double kViscous[]{0.002, 0.003};  // N m s/rad, at the motors
constexpr double kRotor[]{2e-4, 3e-4};      // kg m^2

Matrix2d wrist_matrix() { return (Matrix2d() << 12, 6, 10, -8).finished(); }

constexpr const char* kRobot = R"(format = 1
name = "wrist"
gravity_m_s2 = [0, 0, -9.81]
[[joint]]
name = "pitch"
type = "revolute"
axis = [0, 1, 0]
[joint.link]
mass_kg = 1.2
centre_of_mass_m = [0.1, 0.02, 0]
inertia_kg_m2 = {xx = 0.004, yy = 0.006, zz = 0.005}
[[joint]]
name = "roll"
type = "revolute"
axis = [1, 0, 0]
origin_m = [0.2, 0, 0]
[joint.link]
mass_kg = 0.8
centre_of_mass_m = [0.05, 0.08, 0.03]
inertia_kg_m2 = {xx = 0.003, yy = 0.002, zz = 0.002}
[transmission]
matrix = [[12, 6], [10, -8]]
offset_rad = [0.4, -0.2]
torque_constant = [0.05, 0.08]
[channels]
motor_position = [{source = "m1", unit = "deg"}, {source = "m2", unit = "deg"}]
motor_current = ["i1", "i2"]
)";

std::string effect(const char* kind, int motor, const std::string& parameters) {
  return std::string("[[effect]]\nkind = \"") + kind + "\"\nmotor = " + std::to_string(motor) +
         "\n" + parameters + "\n";
}

std::string frictions() {
  return effect("viscous_friction", 1, "coefficient = " + desk::shortest(kViscous[0])) +
         effect("viscous_friction", 2, "coefficient = " + desk::shortest(kViscous[1]));
}

std::string rotors() {
  return effect("rotor_inertia", 1, "inertia = " + desk::shortest(kRotor[0])) +
         effect("rotor_inertia", 2, "inertia = " + desk::shortest(kRotor[1]));
}

RobotDescription wrist(const std::string& effects) {
  return desk::parse_robot(kRobot + effects, "wrist.toml");
}

// The same arm; `more` has what makes motors of it.
std::string mjcf(const std::string& bodies, const std::string& more) {
  return R"(<mujoco><compiler angle="radian" inertiafromgeom="false"/>
<option gravity="0 0 -9.81" timestep="0.0005" integrator="RK4"/>
<worldbody><body><joint name="pitch" axis="0 1 0"/>
<inertial mass="1.2" pos="0.1 0.02 0" diaginertia="0.004 0.006 0.005"/>
<body pos="0.2 0 0"><joint name="roll" axis="1 0 0"/>
<inertial mass="0.8" pos="0.05 0.08 0.03" diaginertia="0.003 0.002 0.002"/></body></body>)" +
         bodies + "</worldbody>" + more + "</mujoco>";
}

std::string tendon(const char* name, double pitch, double roll, double damping) {
  return std::string("<fixed name=\"") + name + "\" damping=\"" + desk::shortest(damping) +
         "\"><joint joint=\"pitch\" coef=\"" + desk::shortest(pitch) +
         "\"/><joint joint=\"roll\" coef=\"" + desk::shortest(roll) + "\"/></fixed>";
}

// Motors that pull tendons with friction of the tendons' own speed.
std::string with_tendons() {
  const Matrix2d a = wrist_matrix();
  return mjcf("", "<tendon>" + tendon("m1", a(0, 0), a(0, 1), kViscous[0]) +
                      tendon("m2", a(1, 0), a(1, 1), kViscous[1]) +
                      "</tendon><actuator><motor tendon=\"m1\"/><motor tendon=\"m2\"/></actuator>");
}

std::string rotor_name(int motor) { return "r" + std::to_string(motor + 1); }

// It turns beside the arm.
std::string rotor_body(int motor) {
  const std::string inertia = desk::shortest(kRotor[motor]);
  return "<body pos=\"1 0 0\"><joint name=\"" + rotor_name(motor) +
         "\" axis=\"0 0 1\"/><inertial mass=\"1e-3\" pos=\"0 0 0\" diaginertia=\"" + inertia + " " +
         inertia + " " + inertia + "\"/></body>";
}

// Rotors that turn beside the arm, held to the tendons by constraints.
std::string with_rotors() {
  const Matrix2d a = wrist_matrix();
  std::string bodies;
  std::string tendons;
  std::string equalities;
  for (int motor = 0; motor < 2; ++motor) {
    const std::string name = rotor_name(motor);
    bodies += rotor_body(motor);
    tendons += tendon(("m" + std::to_string(motor + 1)).c_str(), a(motor, 0), a(motor, 1), 0) +
               "<fixed name=\"t" + name + "\"><joint joint=\"" + name + "\" coef=\"1\"/></fixed>";
    equalities += "<tendon tendon1=\"t" + name + "\" tendon2=\"m" + std::to_string(motor + 1) +
                  "\" solimp=\"0.99999 0.99999 0.001\"/>";
  }
  return mjcf(bodies, "<tendon>" + tendons + "</tendon><equality>" + equalities + "</equality>");
}

class MujocoArm {
 public:
  explicit MujocoArm(const std::string& text) {
    const TemporaryFolder folder;
    put(folder / "arm.xml", text);
    char error[1000] = "";
    model_.reset(mj_loadXML((folder / "arm.xml").c_str(), nullptr, error, sizeof error));
    if (model_ == nullptr) throw std::runtime_error(error);
    data_.reset(mj_makeData(model_.get()));
  }
  mjModel* model() { return model_.get(); }
  mjData* operator->() { return data_.get(); }
  mjData* data() { return data_.get(); }

 private:
  std::unique_ptr<mjModel, decltype(&mj_deleteModel)> model_{nullptr, mj_deleteModel};
  std::unique_ptr<mjData, decltype(&mj_deleteData)> data_{nullptr, mj_deleteData};
};

Motion instant(const Vector2d& q, const Vector2d& dq, const Vector2d& ddq) {
  return {Eigen::VectorXd::Zero(1), q.transpose(), dq.transpose(), ddq.transpose()};
}

Vector2d random_pair(std::mt19937_64& generator, double size) {
  std::uniform_real_distribution<double> uniform(-size, size);
  const double first = uniform(generator);
  return {first, uniform(generator)};
}

TEST(CoupledWrist, NeedsTheTorquesThatMujocoNeedsWithTendons) {
  MujocoArm arm(with_tendons());
  const RobotDescription robot = wrist(frictions());
  std::mt19937_64 generator = seeded_generator();
  for (int i = 0; i < repetitions(500); ++i) {
    const Vector2d q = random_pair(generator, 2);
    const Vector2d dq = random_pair(generator, 3);
    const Vector2d ddq = random_pair(generator, 20);
    Vector2d::Map(arm->qpos) = q;
    Vector2d::Map(arm->qvel) = dq;
    Vector2d::Map(arm->qacc) = ddq;
    mj_inverse(arm.model(), arm.data());
    const Vector2d theirs = Vector2d::Map(arm->qfrc_inverse);
    const Vector2d ours = desk::model_torque(robot, instant(q, dq, ddq)).row(0);
    EXPECT_LT((ours - theirs).norm(), 1e-9 * (1 + theirs.norm()));
    // Lengths are the motors' angles, and what motors give reaches the joints as a power does.
    EXPECT_LT((Vector2d::Map(arm->ten_length) - wrist_matrix() * q).norm(), 1e-12);
    Vector2d::Map(arm->ctrl) = random_pair(generator, 1);
    const Vector2d given = wrist_matrix().transpose() * Vector2d::Map(arm->ctrl);
    mj_forward(arm.model(), arm.data());
    EXPECT_LT((Vector2d::Map(arm->qfrc_actuator) - given).norm(), 1e-12);
  }
}

TEST(CoupledWrist, CarriesRotorsAsMujocoDoesByConstraints) {
  MujocoArm arm(with_rotors());
  ASSERT_EQ(arm.model()->nv, 4);
  const RobotDescription with = wrist(rotors());
  const RobotDescription without = wrist("");
  std::mt19937_64 generator = seeded_generator();
  double worst_without = 0;
  for (int i = 0; i < repetitions(200); ++i) {
    const Vector2d q = random_pair(generator, 1);
    const Vector2d dq = random_pair(generator, 2);
    const Vector2d tau = random_pair(generator, 5);
    Vector2d::Map(arm->qpos) = q;
    Vector2d::Map(arm->qvel) = dq;
    Vector2d::Map(arm->qpos + 2) = wrist_matrix() * q;
    Vector2d::Map(arm->qvel + 2) = wrist_matrix() * dq;
    Vector2d::Map(arm->qfrc_applied) = tau;
    mj_forward(arm.model(), arm.data());
    const Motion motion = instant(q, dq, Vector2d::Map(arm->qacc));
    const auto error = [&](const RobotDescription& robot) {
      return (Vector2d(desk::model_torque(robot, motion).row(0)) - tau).norm() / tau.norm();
    };
    EXPECT_LT(error(with), 2e-3);
    worst_without = std::max(worst_without, error(without));
  }
  EXPECT_GT(worst_without, 0.1);
}

// Rotors that turn beside the arm, each on a spring that its gear turns the other end of.
constexpr double kSpring[]{0.5, 0.4};  // N m/rad
std::string with_springs() {
  const Matrix2d a = wrist_matrix();
  std::string bodies;
  std::string tendons;
  std::string motors;
  for (int motor = 0; motor < 2; ++motor) {
    const std::string name = rotor_name(motor);
    bodies += rotor_body(motor);
    tendons += "<fixed stiffness=\"" + desk::shortest(kSpring[motor]) +
               "\" damping=\"0.002\" springlength=\"0\"><joint joint=\"pitch\" coef=\"" +
               desk::shortest(a(motor, 0)) + "\"/><joint joint=\"roll\" coef=\"" +
               desk::shortest(a(motor, 1)) + "\"/><joint joint=\"" + name +
               "\" coef=\"-1\"/></fixed>";
    motors += "<motor joint=\"" + name + "\"/>";
  }
  return mjcf(bodies, "<tendon>" + tendons + "</tendon><actuator>" + motors + "</actuator>");
}

// Recorded at the rotors, as joints: what drives of a coupled wrist know.
Log log_with_springs() {
  MujocoArm arm(with_springs());
  constexpr int kEvery = 4;
  constexpr int kSteps = 16000;
  constexpr int kSettled = 4000;
  constexpr Index kRows = (kSteps - kSettled) / kEvery;
  Log log;
  log.file = "springs";
  log.t_s.resize(kRows);
  log.period_s = kEvery * 0.0005;
  for (Eigen::MatrixXd* values : {&log.q, &log.dq, &log.tau}) values->resize(kRows, 2);
  log.dq_derived = {false, false};
  const Matrix2d joint_per_motor = wrist_matrix().inverse();
  for (int step = 0; step < kSteps; ++step) {
    const double t = arm->time;
    const Vector2d wanted(0.6 * std::sin(4.1 * t), 0.5 * std::sin(6.3 * t));
    const Vector2d wanted_velocity(2.46 * std::cos(4.1 * t), 3.15 * std::cos(6.3 * t));
    const Vector2d motors = Vector2d::Map(arm->qpos + 2);
    const Vector2d velocity = Vector2d::Map(arm->qvel + 2);
    const Vector2d given = 0.3 * (wrist_matrix() * wanted - motors) +
                           0.02 * (wrist_matrix() * wanted_velocity - velocity);
    Vector2d::Map(arm->ctrl) = given;
    if (step >= kSettled && step % kEvery == 0) {
      const Index row = (step - kSettled) / kEvery;
      log.t_s[row] = t;
      log.q.row(row) = joint_per_motor * motors;
      log.dq.row(row) = joint_per_motor * velocity;
      log.tau.row(row) = wrist_matrix().transpose() * given;
    }
    mj_step(arm.model(), arm.data());
  }
  return log;
}

TEST(CoupledWrist, GivesWayAtItsMotorsAsMujocosSpringsDo) {
  std::string springs;
  for (int motor : {1, 2}) {
    springs +=
        effect("joint_elasticity", motor, "stiffness = " + desk::shortest(kSpring[motor - 1]));
  }
  const RobotDescription elastic = wrist(rotors() + springs);
  ASSERT_EQ(elastic.effects.size(), 4U);
  ASSERT_TRUE(elastic.effects[2].of_motor);
  const auto measured = desk::measure(log_with_springs(), elastic);
  const desk::Comparison with = desk::compare(elastic, measured);
  const desk::Comparison without = desk::compare(wrist(rotors()), measured);
  for (std::size_t joint = 0; joint < 2; ++joint) {
    EXPECT_LT(with.joints[joint].relative_error_percent,
              0.2 * without.joints[joint].relative_error_percent)
        << joint;
    EXPECT_GT(without.joints[joint].relative_error_percent, 0.5) << joint;
  }
}

TEST(CoupledWrist, HasTheSpringOfAMotorFittedAsMujocoHasIt) {
  for (const int motor : {0, 1}) {
    const int other = 1 - motor;
    const RobotDescription robot =
        wrist(rotors() + effect("joint_elasticity", other + 1,
                                "stiffness = " + desk::shortest(kSpring[other])));
    desk::AddRequest request;
    request.effects = {EffectKind::kJointElasticity};
    request.joint = static_cast<std::size_t>(motor);
    request.of_motor = true;
    const desk::AddResult result = desk::add(robot, request, {log_with_springs()}, {});
    const desk::RobotEffect& found = result.robot.effects.at(result.added.at(0));
    EXPECT_TRUE(found.of_motor);
    EXPECT_EQ(found.joint, static_cast<std::size_t>(motor));
    EXPECT_NEAR(found.parameters[0], kSpring[motor], 0.1 * kSpring[motor]) << motor;
  }
}

// What a rig records that knows motors alone: angles in degrees, currents.
std::string recording(double coulomb = 0, double smoothing = 1) {
  MujocoArm arm(with_tendons());
  std::string csv = "t,m1,m2,i1,i2,s1,s2\n";
  constexpr double kDeg = 180 / 3.14159265358979323846;
  for (int step = 0; step < 16000; ++step) {
    const double t = arm->time;
    const Vector2d wanted(0.6 * std::sin(2.1 * t), 0.5 * std::sin(3.3 * t));
    const Vector2d wanted_velocity(1.26 * std::cos(2.1 * t), 1.65 * std::cos(3.3 * t));
    const Vector2d tau =
        60 * (wanted - Vector2d::Map(arm->qpos)) + 4 * (wanted_velocity - Vector2d::Map(arm->qvel));
    Vector2d::Map(arm->ctrl) = wrist_matrix().transpose().inverse() * tau;
    if (step % 4 == 0) {
      mj_forward(arm.model(), arm.data());
      const Vector2d turning = wrist_matrix() * Vector2d::Map(arm->qvel);
      const double dry = coulomb * std::tanh(turning[0] / smoothing);
      const Vector2d sensed =
          tau + Vector2d::Map(arm->qfrc_passive);  // behind the friction of the motors
      for (const double value :
           {t, (arm->ten_length[0] + 0.4) * kDeg, (arm->ten_length[1] - 0.2) * kDeg,
            (arm->ctrl[0] + dry) / 0.05, arm->ctrl[1] / 0.08, sensed[0], sensed[1]}) {
        csv += desk::shortest(value) + ",";
      }
      csv.back() = '\n';
    }
    mj_step(arm.model(), arm.data());
  }
  return csv;
}

class WristRecording : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { csv_ = recording(); }

  static Log read(const RobotDescription& robot) {
    const TemporaryFile file("wrist.csv", csv_);
    return desk::read_log(file.path(), robot);
  }

  static inline std::string csv_;
};

TEST_F(WristRecording, OfMotorsIsMetByTheModelOfTheJoints) {
  const RobotDescription robot = wrist(frictions());
  const auto measured = desk::measure(read(robot), robot);
  for (const auto& joint : desk::compare(robot, measured).joints) {
    EXPECT_LT(joint.relative_error_percent, 0.5) << joint.joint;
  }
  for (const auto& joint : desk::compare(wrist(""), measured).joints) {
    EXPECT_GT(joint.relative_error_percent, 5) << joint.joint;
  }
}

TEST_F(WristRecording, FrictionOfAMotorIsFoundOnItsShaft) {
  const RobotDescription robot =
      wrist(effect("viscous_friction", 2, "coefficient = " + desk::shortest(kViscous[1])));
  desk::AddRequest request;
  request.effects = {EffectKind::kViscousFriction};
  request.joint = 0;
  request.of_motor = true;
  const desk::AddResult result = desk::add(robot, request, {read(robot)}, {});
  EXPECT_TRUE(result.may_be_written(false))
      << ::testing::PrintToString(result.objections) << ::testing::PrintToString(result.doubts);
  ASSERT_EQ(result.robot.effects.size(), 2U);
  const desk::RobotEffect& found = result.robot.effects[1];
  EXPECT_TRUE(found.of_motor);
  EXPECT_EQ(found.joint, 0);
  EXPECT_NEAR(found.parameters[0], kViscous[0], 0.03 * kViscous[0]);
}

TEST_F(WristRecording, FrictionOfTheOtherMotorIsFittedAgainWithIt) {
  RobotDescription robot =
      wrist(effect("viscous_friction", 2, "coefficient = 0.001\nfitted = true"));
  desk::AddRequest request;
  request.effects = {EffectKind::kViscousFriction};
  request.of_motor = true;
  const desk::AddResult result = desk::add(robot, request, {read(robot)}, {});
  EXPECT_NEAR(result.robot.effects[0].parameters[0], kViscous[1], 0.03 * kViscous[1]);
  EXPECT_NEAR(result.robot.effects[1].parameters[0], kViscous[0], 0.03 * kViscous[0]);
  EXPECT_THAT(result.notes,
              ::testing::Contains(::testing::HasSubstr("viscous_friction on motor 2")));
}

// How wide its change of sign is, is the motor's own number, of its own speed.
TEST(DryFrictionOfAMotor, IsFoundWithItsSmoothingOnItsShaft) {
  constexpr double kLevel = 0.02;
  constexpr double kSmoothing = 0.6;
  const RobotDescription robot = wrist(frictions());
  const TemporaryFile file("wrist.csv", recording(kLevel, kSmoothing));
  desk::AddRequest request;
  request.effects = {EffectKind::kCoulombFriction};
  request.of_motor = true;
  const desk::AddResult result =
      desk::add(robot, request, {desk::read_log(file.path(), robot)}, {});
  const std::size_t added = result.added.at(0);
  const desk::RobotEffect& found = result.robot.effects[added];
  EXPECT_TRUE(found.of_motor);
  EXPECT_NEAR(found.parameters[0], kLevel, 0.03 * kLevel);
  EXPECT_NEAR(found.parameters[1], kSmoothing, 0.2 * kSmoothing);
  const auto told =
      std::find_if(result.fit.parameters.begin(), result.fit.parameters.end(),
                   [&](const auto& one) { return one.effect == added && one.parameter == 1; });
  ASSERT_NE(told, result.fit.parameters.end()) << "the smoothing is not told";
  EXPECT_TRUE(told->fitted);
}

TEST_F(WristRecording, DriveLessSensorIsTheGear) {
  RobotDescription robot = wrist(frictions());
  desk::Channel sensor;
  sensor.source = "s1";
  robot.channels->sensor_torque = {sensor, std::nullopt};
  const auto measured = desk::measure(read(robot), robot);
  const desk::Comparison comparison = desk::compare(robot, measured);
  ASSERT_TRUE(comparison.joints[0].gear.has_value());
  EXPECT_FALSE(comparison.joints[1].gear.has_value());
  const desk::GearTorque& gear = *comparison.joints[0].gear;
  // A^T friction A dq, whose first row is over both velocities.
  const Eigen::VectorXd friction = (comparison.dq * wrist_matrix().transpose() *
                                    Vector2d::Map(kViscous).asDiagonal() * wrist_matrix())
                                       .col(0);
  const double rms = friction.norm() / std::sqrt(static_cast<double>(friction.size()));
  EXPECT_NEAR(gear.rms, rms, 0.02 * rms);
  EXPECT_EQ(gear.follows.variable, "velocity");
}

TEST_F(WristRecording, ASensorAloneSeesTheLinksAndNoFrictionOfMotors) {
  RobotDescription robot = wrist(frictions());
  desk::Channel sensor;
  robot.channels->torque_of = {desk::ChannelOf::kSensor, desk::ChannelOf::kSensor};
  for (std::size_t joint = 0; joint < 2; ++joint) {
    robot.channels->torque[joint].source = joint == 0 ? "s1" : "s2";
  }
  const Log log = read(robot);
  EXPECT_THAT(log.remarks, ::testing::Contains(::testing::HasSubstr("sensor behind the gear")));
  const auto measured = desk::measure(log, robot);
  for (const auto& joint : desk::compare(robot, measured).joints) {
    EXPECT_LT(joint.relative_error_percent, 0.5) << joint.joint;
  }
  desk::AddRequest request;
  request.effects = {EffectKind::kRotorInertia};
  EXPECT_THAT(message_of<desk::InputError>([&] { desk::add(wrist(""), request, {log}, {}); }),
              ::testing::HasSubstr("does not see rotor_inertia of joint 1"));
  request.effects = {EffectKind::kViscousFriction};
  EXPECT_THAT(message_of<desk::InputError>([&] { desk::add(robot, request, {log}, {}); }),
              ::testing::HasSubstr("does not see viscous_friction of motor 1"));
}

TEST(AddToAMotor, IsRefusedWhereThereIsNone) {
  const RobotDescription robot = wrist("");
  const Log log;
  desk::AddRequest request;
  request.effects = {EffectKind::kTorqueScale};
  request.of_motor = true;
  const auto refusal = [&](const RobotDescription& of) {
    return message_of<desk::InputError>([&] { desk::add(of, request, {log}, {}); });
  };
  EXPECT_THAT(refusal(robot), ::testing::AllOf(::testing::HasSubstr("--motor: found torque_scale"),
                                               ::testing::HasSubstr("rotor_inertia")));
  RobotDescription bare = robot;
  bare.transmission.reset();
  EXPECT_THAT(refusal(bare), ::testing::HasSubstr("no [transmission]"));
  request.joint = 2;
  EXPECT_THAT(refusal(robot), ::testing::HasSubstr("1 to 2, the motors"));
}

}  // namespace
}  // namespace offnominal::test
