// The plant of a robot file against the closed form of the paper's arm, and against laws.
#include "sil/robot_plant.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/error.hpp"
#include "desk/sil/serial_robot.hpp"
#include "offnominal/sim/two_link_plant.hpp"
#include "paper/two_link_robot.hpp"

namespace offnominal::desk::sil {
namespace {

using Eigen::Vector2d;
using sim::FaultEvent;
using sim::FaultEventKind;
using sim::JointVector;

constexpr double kPeriodS = 0.001;

RobotEffect effect_of(EffectKind kind, int joint, std::initializer_list<double> parameters) {
  RobotEffect effect;
  effect.kind = kind;
  effect.joint = static_cast<std::uint8_t>(joint);
  std::copy(parameters.begin(), parameters.end(), effect.parameters.begin());
  return effect;
}

sim::JointState resting(Eigen::Index joints) {
  return {JointVector::Zero(joints), JointVector::Zero(joints)};
}

// Both arms from one start under torques that change, for a second.
void expect_same_motion(const std::vector<FaultEvent>& faults, const sim::Fault& fault) {
  const sim::TwoLinkPlant closed_form({}, fault, sim::no_uncertainty());
  sim::TwoLinkState state{{0.3, -0.4}, {0.5, -0.2}};
  const auto plant =
      make_robot_plant({paper::two_link_robot(), {}, faults, {state.q, state.dq}, kPeriodS});
  for (int tick = 0; tick < 1000; ++tick) {
    const double t_s = tick * kPeriodS;
    const Vector2d tau(30 + 5 * std::sin(7 * t_s), 15 + 3 * std::cos(5 * t_s));
    const Vector2d psi = closed_form.fault_function(t_s, state, tau);
    ASSERT_LT((plant->fault_function(t_s, tau) - psi).norm(), 1e-3 * (1 + psi.norm())) << t_s;
    state = closed_form.step(t_s, state, tau, kPeriodS);
    plant->step(t_s, tau, kPeriodS);
    ASSERT_LT((plant->state().q - state.q).norm(), 5e-6) << t_s;
    ASSERT_LT((plant->state().dq - state.dq).norm(), 2e-5) << t_s;
  }
}

TEST(RobotPlant, OfThePapersFileMovesAsItsClosedForm) { expect_same_motion({}, {}); }

TEST(RobotPlant, LosesMassAsTheClosedFormDoes) {
  expect_same_motion({{.kind = FaultEventKind::kMassLoss,
                       .begin_s = 0.2,
                       .joint = 0,
                       .size = 0.75,
                       .rate_per_s = 2.0}},
                     {.kind = sim::FaultKind::kMassLoss, .time_s = 0.2, .rate_per_s = 2.0});
}

// Its second link is a point mass: a payload there is one at the tip.
TEST(RobotPlant, CarriesAPayloadAsTheClosedFormDoes) {
  expect_same_motion(
      {{.kind = FaultEventKind::kPayload, .begin_s = 0.2, .size = 1.5, .rate_per_s = 3.0}},
      {.kind = sim::FaultKind::kPayload, .time_s = 0.2, .rate_per_s = 3.0, .payload_kg = 1.5});
}

// Without friction nothing is lost, but for the method's own error, which falls with its order.
TEST(RobotPlant, StepIsOfOrderTwo) {
  const sim::TwoLinkPlant closed_form({}, {}, sim::no_uncertainty());
  const sim::TwoLinkState start{{0.3, -0.4}, {1.5, -2.0}};
  const Vector2d tau(20, 5);
  const sim::TwoLinkState truth = closed_form.step(0, start, tau, 0.4, 4000);
  const auto error = [&](double period_s) {
    const auto plant =
        make_robot_plant({paper::two_link_robot(), {}, {}, {start.q, start.dq}, period_s});
    const long steps = std::lround(0.4 / period_s);
    for (long i = 0; i < steps; ++i) {
      plant->step(static_cast<double>(i) * period_s, tau, period_s);
    }
    return (plant->state().q - truth.q).norm() + (plant->state().dq - truth.dq).norm();
  };
  for (const double period_s : {4e-4, 2e-4}) {
    const double ratio = error(period_s) / error(period_s / 2);
    EXPECT_GT(ratio, 3.6) << period_s;
    EXPECT_LT(ratio, 4.4) << period_s;
  }
}

// GIVEN friction far steeper at rest than an explicit step could bear WHEN a light link turns with
// it THEN it comes to rest and stays there, under a torque that the friction can hold.
TEST(RobotPlant, ComesToRestUnderFrictionOnALightLink) {
  const RobotDescription robot = test::serial_robot(6);
  RobotDescription weightless = robot;
  weightless.gravity_m_s2 = {0, 0, 0};
  sim::JointState start = resting(6);
  start.dq[5] = 3.0;
  const auto plant = make_robot_plant({weightless,
                                       {effect_of(EffectKind::kCoulombFriction, 5, {20.0, 1e-3})},
                                       {},
                                       start,
                                       kPeriodS});
  JointVector tau = JointVector::Zero(6);
  tau[5] = 5.0;
  double fastest_at_the_end = 0;
  for (int tick = 0; tick < 500; ++tick) {
    plant->step(tick * kPeriodS, tau, kPeriodS);
    if (tick > 250) {
      fastest_at_the_end = std::max(fastest_at_the_end, std::abs(plant->state().dq[5]));
    }
  }
  EXPECT_LT(fastest_at_the_end, 1e-3);
  EXPECT_GT(fastest_at_the_end, 1e-6) << "friction without a memory creeps";
}

TEST(RobotPlant, HidesWhatItsFileDoesNotKnowAndCallsItNoFault) {
  const RobotDescription robot = test::serial_robot(3);
  const auto plant = make_robot_plant(
      {robot, {effect_of(EffectKind::kTorqueOffset, 2, {1.0})}, {}, resting(3), kPeriodS});
  const auto open = make_robot_plant({robot, {}, {}, resting(3), kPeriodS});
  const JointVector tau = JointVector::Zero(3);
  plant->step(0, tau, kPeriodS);
  open->step(0, tau, kPeriodS);
  EXPECT_LT(plant->state().dq[2], open->state().dq[2] - 1e-3);
  EXPECT_EQ(plant->fault_function(0, tau), JointVector::Zero(3));
}

TEST(RobotPlant, GivesATorqueLateThatItsDriveGivesLate) {
  RobotDescription robot = test::serial_robot(1);
  robot.gravity_m_s2 = {0, 0, 0};
  robot.effects = {effect_of(EffectKind::kTimeDelay, 0, {0.005})};
  const auto plant = make_robot_plant({robot, {}, {}, resting(1), kPeriodS});
  JointVector tau = JointVector::Zero(1);
  plant->step(0, tau, kPeriodS);
  tau[0] = 2.0;
  for (int tick = 1; tick <= 5; ++tick) {
    plant->step(tick * kPeriodS, tau, kPeriodS);
    EXPECT_EQ(plant->state().dq[0], 0.0) << tick;
  }
  plant->step(6 * kPeriodS, tau, kPeriodS);
  EXPECT_GT(plant->state().dq[0], 0.0);
}

TEST(RobotPlant, RefusesEffectsThatTheCoreRefuses) {
  EXPECT_THROW(static_cast<void>(make_robot_plant({test::serial_robot(1),
                                                   {effect_of(EffectKind::kTimeDelay, 0, {1.0})},
                                                   {},
                                                   resting(1),
                                                   kPeriodS})),
               InputError);
}

TEST(RobotPlant, RefusesHiddenEffectsThatItCannotCarry) {
  for (const EffectKind kind : {EffectKind::kJointElasticity, EffectKind::kBacklash}) {
    EXPECT_THROW(
        static_cast<void>(make_robot_plant(
            {test::serial_robot(1), {effect_of(kind, 0, {1.0})}, {}, resting(1), kPeriodS})),
        InputError);
  }
}

}  // namespace
}  // namespace offnominal::desk::sil
