#include "compare/transmission.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "compare/compare.hpp"
#include "compare/inverse_model.hpp"
#include "compare/measurement.hpp"
#include "recorded_arm.hpp"

// A mass on a slide: what a drive has to supply behind a transmission that gives way, by hand.

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kMassKg = 4;
constexpr double kRateHz = 1000;
constexpr double kTorqueN = 30;
constexpr double kWave = 2 * std::numbers::pi * 1.5;  // rad/s

RobotDescription slide() {
  RobotDescription robot;
  robot.name = "slide";
  robot.gravity_m_s2 = {0, 0, 0};
  RobotJoint joint;
  joint.name = "x";
  joint.joint.type = JointType::kPrismatic;
  joint.joint.axis = {1, 0, 0};
  joint.joint.mass_kg = kMassKg;
  robot.joints.push_back(joint);
  return robot;
}

RobotDescription with(EffectKind kind, double size) {
  RobotDescription robot = slide();
  robot.effects.push_back(test::effect_of(kind, 0, {size}, false));
  return robot;
}

// The motor in a sine of 0.1 m and a drive that gives a sine of its own.
Log sine() {
  const Index samples = 6001;
  Log log;
  log.file = "sine";
  log.period_s = 1 / kRateHz;
  log.t_s = VectorXd::LinSpaced(samples, 0, static_cast<double>(samples - 1) / kRateHz);
  log.q = 0.1 * (kWave * log.t_s.array()).sin().matrix();
  log.dq = 0.1 * kWave * (kWave * log.t_s.array()).cos().matrix();
  log.tau = kTorqueN * (kWave * log.t_s.array()).sin().matrix();
  log.dq_derived = {false};
  return log;
}

TEST(TransmissionTorque, OfAnElasticJointIsThatOfTheLinkBehindTheMotor) {
  constexpr double kStiffness = 2000;
  const Measurement measured = measure(sine(), slide());
  const Comparison stiff = compare(slide(), measured);
  const Comparison soft = compare(with(EffectKind::kJointElasticity, kStiffness), measured);
  // x = tau / K lags nothing: its acceleration is -w^2 x, and the mass asks for that much less.
  double largest = 0;
  for (Index i = 0; i < stiff.t_s.size(); ++i) {
    const double expected =
        kMassKg * kWave * kWave * kTorqueN / kStiffness * std::sin(kWave * stiff.t_s[i]);
    EXPECT_NEAR(soft.model(i, 0) - stiff.model(i, 0), expected, 0.06) << stiff.t_s[i];
    largest = std::max(largest, std::abs(expected));
  }
  EXPECT_GT(largest, 5);
}

// What is carried is behind the transmission too, as the link itself is.
TEST(TransmissionTorque, IsTheSameOfAMassThatIsCarried) {
  constexpr double kCarriedKg = 3;
  const Measurement measured = measure(sine(), slide());
  for (const RobotDescription& robot :
       {with(EffectKind::kJointElasticity, 2000), with(EffectKind::kBacklash, 0.004)}) {
    RobotDescription carrying = robot;
    carrying.effects.push_back(
        test::effect_of(EffectKind::kTipPayload, 0, {kCarriedKg, 0, 0, 0}, false));
    RobotDescription heavier = robot;
    heavier.joints[0].joint.mass_kg += kCarriedKg;
    EXPECT_LT((compare(carrying, measured).model - compare(heavier, measured).model)
                  .cwiseAbs()
                  .maxCoeff(),
              1e-6);
  }
}

TEST(TransmissionTorque, OfAStiffJointOrOneWithHardlyAnyPlayIsNearlyNone) {
  const Measurement measured = measure(sine(), slide());
  const Comparison rigid = compare(slide(), measured);
  for (const RobotDescription& robot :
       {with(EffectKind::kJointElasticity, 1e9), with(EffectKind::kBacklash, 1e-9)}) {
    const Comparison nearly = compare(robot, measured);
    EXPECT_LT((nearly.model - rigid.model).cwiseAbs().maxCoeff(), 1e-3);
  }
}

// The link waits at one side until the drive pulls it from the other: while it does, the motor
// moves alone and the drive has less to supply.
TEST(TransmissionTorque, OfPlayShowsAtReversalsOfTheLoad) {
  const Measurement measured = measure(sine(), slide());
  const VectorXd change = compare(with(EffectKind::kBacklash, 0.004), measured).model.col(0) -
                          compare(slide(), measured).model.col(0);
  double at_reversals = 0;
  double between = 0;
  for (Index i = 0; i < change.size(); ++i) {
    const double load = std::abs(std::sin(kWave * measured.t_s[i]));
    if (load < 0.3) at_reversals = std::max(at_reversals, std::abs(change[i]));
    if (load > 0.95) between = std::max(between, std::abs(change[i]));
  }
  EXPECT_GT(at_reversals, 1);
  EXPECT_LT(between, 0.5 * at_reversals);
}

RobotEffect spring_of_motor(std::uint8_t motor, double stiffness) {
  RobotEffect spring = test::effect_of(EffectKind::kJointElasticity, motor, {stiffness}, false);
  spring.of_motor = true;
  return spring;
}

TEST(TransmissionTorque, OfAnElasticMotorIsThatOfTheJointBehindItsGear) {
  constexpr double kRatio = -25;
  constexpr double kStiffness = 2000;  // at the joint
  RobotDescription at_motor = slide();
  at_motor.transmission.emplace().ratio = {kRatio};
  at_motor.effects.push_back(spring_of_motor(0, kStiffness / (kRatio * kRatio)));
  const Measurement measured = measure(sine(), slide());
  const Eigen::MatrixXd at_joint =
      compare(with(EffectKind::kJointElasticity, kStiffness), measured).model;
  EXPECT_LT((compare(at_motor, measured).model - at_joint).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_GT((compare(slide(), measured).model - at_joint).cwiseAbs().maxCoeff(), 5);
}

// Two slides across each other, so that each mass asks for a force of its own, and motors that they
// share: A = [30 0; 20 20], A^-1 = [1/30 0; -1/30 1/20]. Motor 1 gives tau1 / 30 - tau2 / 30, and
// where its spring gives way by x the slides are behind by x / 30 and -x / 30.
TEST(TransmissionTorque, OfAnElasticMotorThatJointsShareIsThatOfAllOfThem) {
  constexpr double kSecondKg = 2.5;
  constexpr double kStiffness = 3;  // N m/rad
  RobotDescription robot = slide();
  robot.joints.push_back(robot.joints[0]);
  robot.joints[1].name = "y";
  robot.joints[1].joint.axis = {0, 1, 0};
  robot.joints[1].joint.mass_kg = kSecondKg;
  robot.transmission.emplace().matrix = {{30, 0}, {20, 20}};
  Log log = sine();
  const VectorXd q = log.q;
  const VectorXd dq = log.dq;
  const VectorXd tau = log.tau;
  log.q.resize(q.size(), 2);
  log.dq.resize(q.size(), 2);
  log.tau.resize(q.size(), 2);
  log.q << q, 0.5 * q;
  log.dq << dq, 0.5 * dq;
  log.tau << tau, -2 * tau;
  log.dq_derived = {false, false};
  const Measurement measured = measure(log, robot);
  const Comparison stiff = compare(robot, measured);
  robot.effects.push_back(spring_of_motor(0, kStiffness));
  const Comparison soft = compare(robot, measured);
  double largest = 0;
  for (Index i = 0; i < stiff.t_s.size(); ++i) {
    const double gives_way_by =
        (1 + 2) * kTorqueN / 30 / kStiffness * std::sin(kWave * stiff.t_s[i]);
    const double less = kWave * kWave * gives_way_by / 30;
    EXPECT_NEAR(soft.model(i, 0) - stiff.model(i, 0), (kMassKg + kSecondKg) * less, 0.15);
    EXPECT_NEAR(soft.model(i, 1) - stiff.model(i, 1), -kSecondKg * less, 0.06);
    largest = std::max(largest, std::abs(less));
  }
  EXPECT_GT(largest, 2);
}

TEST(ModelTorque, TakesTransmissionsForRigid) {
  const Measurement measured = measure(sine(), slide());
  const auto of = [&](const RobotDescription& robot) {
    return model_torque(robot, measured.motion);
  };
  EXPECT_EQ(of(with(EffectKind::kJointElasticity, 2000)), of(slide()));
  EXPECT_TRUE(has_transmission_effect(with(EffectKind::kBacklash, 0.1)));
  EXPECT_FALSE(has_transmission_effect(slide()));
}

}  // namespace
}  // namespace offnominal::desk
