#include "offnominal/sim/hidden/plant.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace offnominal::sim::hidden {
namespace {

using Eigen::Vector2d;

constexpr double kStepS = 1e-4;

Robot bare_robot() {
  Robot robot;
  robot.links = {RigidLink{4.0, 0.5, 0.24, 0.08}, RigidLink{2.0, 0.4, 0.2, 0.025}};
  for (RobotJoint& joint : robot.joints) joint.transmission.rotor_inertia_kg_m2 = 0.1;
  return robot;
}

double energy(const Robot& robot, const PlantState& s) {
  double sum = robot.arm().energy(s.link_q, s.link_dq);
  for (int j = 0; j < 2; ++j) {
    const JointTransmission& t = robot.joints[static_cast<std::size_t>(j)].transmission;
    const double pressed = std::max(0.0, std::abs(s.motor_q[j] - s.link_q[j]) - 0.5 * t.gap_rad);
    sum += 0.5 * t.rotor_inertia_kg_m2 * s.motor_dq[j] * s.motor_dq[j];
    if (!t.rigid()) sum += 0.5 * t.stiffness_nm_rad * pressed * pressed;
  }
  return sum;
}

// Largest change of energy over 3 s without a drive, of the energy that swings.
double drift(const Robot& robot, double step_s) {
  const Plant plant(robot);
  PlantState state = plant.start({0.4, -0.7}, {0.5, -1.0});
  const double start = energy(robot, state);
  double worst = 0.0;
  for (double t_s = 0.0; t_s < 3.0; t_s += step_s) {
    plant.step(state, t_s, Vector2d::Zero(), step_s);
    worst = std::max(worst, std::abs(energy(robot, state) - start));
  }
  return worst / 40.0;
}

TEST(HiddenPlant, ConservesEnergyWithoutFrictionAndDrive) {
  EXPECT_LT(drift(bare_robot(), kStepS), 1e-6);
}

TEST(HiddenPlant, IntegratesWithOrderTwo) {
  const double ratio = drift(bare_robot(), 8e-4) / drift(bare_robot(), 4e-4);
  EXPECT_GT(ratio, 3.0);
  EXPECT_LT(ratio, 10.0);
}

TEST(HiddenPlant, ElasticJointsWithPlayConserveEnergyToo) {
  Robot robot = bare_robot();
  robot.joints[0].transmission.stiffness_nm_rad = 300.0;
  robot.joints[1].transmission = {0.1, 2000.0, 0.0, 0.02};
  EXPECT_LT(drift(robot, kStepS), 1e-4);
}

TEST(HiddenPlant, EveryFrictionTakesEnergyOut) {
  Robot robot = bare_robot();
  JointFriction all;
  all.coulomb_nm = 0.3;
  all.viscous_nm_s_rad = 0.05;
  all.quadratic_nm_s2_rad2 = 0.02;
  all.stribeck_nm = 0.2;
  all.coulomb_asymmetry_nm = -0.15;
  all.viscous_asymmetry_nm_s_rad = 0.02;
  all.per_load = 0.05;
  all.cold_coulomb_nm = 0.2;
  all.soft_level_nm = 0.3;
  all.worn_nm = 0.2;
  all.band_nm = 0.2;
  robot.joints[0].friction = robot.joints[1].friction = all;
  const Plant plant(robot);
  PlantState state = plant.start({0.4, -0.7}, {0.5, -1.0});
  const double start = energy(robot, state);
  double lowest = start;
  // What the bristles give back at a reversal, at most: 1/2 level width of all of them.
  const double stored = 0.5 * (1.2 * all.width_rad + all.soft_level_nm * all.soft_width_rad) * 2.0;
  for (double t_s = 0.0; t_s < 5.0; t_s += kStepS) {
    plant.step(state, t_s, Vector2d::Zero(), kStepS);
    const double now = energy(robot, state);
    ASSERT_LT(now, lowest + stored) << "at " << t_s << " s";
    lowest = std::min(lowest, now);
  }
  EXPECT_LT(lowest, start - 5.0);
}

TEST(HiddenPlant, StuckJointGivesByTheBristlesWidth) {
  Robot robot = bare_robot();
  robot.gravity_m_s2 = 0.0;
  for (RobotJoint& joint : robot.joints) joint.friction.coulomb_nm = 2.0;
  const Plant plant(robot);
  PlantState state = plant.start({0.0, 0.3}, {0.0, 0.0});
  for (double t_s = 0.0; t_s < 2.0; t_s += kStepS) plant.step(state, t_s, {1.0, -1.0}, kStepS);
  const Vector2d moved = state.motor_q - Vector2d(0.0, 0.3);
  for (int j = 0; j < 2; ++j) {
    const double width = robot.joints[static_cast<std::size_t>(j)].friction.width_rad;
    EXPECT_GT(std::abs(moved[j]), 0.3 * width);  // pre-sliding: it gives a little
    EXPECT_LT(std::abs(moved[j]), 2.0 * width);  // swung past where it rests
    EXPECT_LT(std::abs(state.motor_dq[j]), 1e-6);
  }
}

TEST(HiddenPlant, StiffTwoMassJointMovesLikeARigidOne) {
  const Robot rigid = bare_robot();
  Robot stiff = rigid;
  for (RobotJoint& joint : stiff.joints) joint.transmission = {0.1, 2e5, 200.0, 0.0};
  const Plant a(rigid), b(stiff);
  PlantState x = a.start({0.3, 0.2}, {0.0, 0.0}), y = b.start({0.3, 0.2}, {0.0, 0.0});
  for (double t_s = 0.0; t_s < 1.0; t_s += 2e-5) {
    const Vector2d tau(6.0 * std::sin(5.0 * t_s), 2.0 * std::sin(7.0 * t_s));
    a.step(x, t_s, tau, 2e-5);
    b.step(y, t_s, tau, 2e-5);
  }
  EXPECT_GT((x.motor_q - Vector2d(0.3, 0.2)).norm(), 0.5);
  EXPECT_LT((x.motor_q - y.motor_q).norm(), 1e-3);
  EXPECT_LT((y.link_q - y.motor_q).norm(), 1e-3);
}

TEST(HiddenPlant, NoTorquePassesTheGap) {
  Robot robot = bare_robot();
  robot.joints[1].transmission = {0.1, 5e3, 20.0, 0.02};
  const Plant plant(robot);
  PlantState state = plant.start({-1.5, 0.1}, {0.0, 0.0});
  // Inside the gap the motor is alone with its inertia.
  state.link_q[1] = state.motor_q[1] + 0.004;
  EXPECT_EQ(plant.transmitted_torque(1, state), 0.0);
  PlantState pushed = state;
  plant.step(pushed, 0.0, {0.0, 0.5}, kStepS);
  EXPECT_NEAR(pushed.motor_dq[1] - state.motor_dq[1], 0.5 / 0.1 * kStepS, 1e-12);
  PlantState let_go = state;
  plant.step(let_go, 0.0, {0.0, 0.0}, kStepS);
  EXPECT_EQ(pushed.link_dq, let_go.link_dq);
  // Flanks push in either direction and never pull.
  state.motor_q[1] = state.link_q[1] + 0.011;
  EXPECT_NEAR(plant.transmitted_torque(1, state), 5e3 * 0.001, 1e-9);
  state.motor_q[1] = state.link_q[1] - 0.011;
  EXPECT_NEAR(plant.transmitted_torque(1, state), -5e3 * 0.001, 1e-9);
  state.motor_dq[1] = 10.0;
  EXPECT_EQ(plant.transmitted_torque(1, state), 0.0);
}

// A robot that steadily slides at one velocity, first joint.
double steady_friction(const JointFriction& friction, double velocity_rad_s, double load_nm = 0.0,
                       double position_rad = 0.0, double t_s = 0.0) {
  Robot robot = bare_robot();
  robot.joints[0].friction = friction;
  PlantState state;
  state.motor_q[0] = position_rad;
  state.motor_dq[0] = velocity_rad_s;
  state.stretch[0] = velocity_rad_s > 0.0 ? 1.0 : -1.0;
  state.soft_stretch[0] = state.stretch[0];
  state.gear_load_nm[0] = load_nm;
  return Plant(robot).friction_torque(0, state, t_s);
}

TEST(HiddenPlant, SlidingFrictionIsWhatItsNumbersSay) {
  JointFriction f;
  f.coulomb_nm = 2.0;
  f.viscous_nm_s_rad = 0.5;
  EXPECT_NEAR(steady_friction(f, 3.0), 3.5, 1e-12);
  EXPECT_NEAR(steady_friction(f, -3.0), -3.5, 1e-12);
  f.coulomb_asymmetry_nm = 0.4;
  f.viscous_asymmetry_nm_s_rad = 0.1;
  EXPECT_NEAR(steady_friction(f, 3.0), 3.5 + 0.7, 1e-12);
  EXPECT_NEAR(steady_friction(f, -3.0), -3.5 + 0.7, 1e-12);
  f = {};
  f.quadratic_nm_s2_rad2 = 0.2;
  EXPECT_NEAR(steady_friction(f, -3.0), -1.8, 1e-12);
  f = {};
  f.stribeck_nm = 1.0;
  f.stribeck_velocity_rad_s = 0.5;
  EXPECT_NEAR(steady_friction(f, 0.5), std::exp(-1.0), 1e-12);
  f = {};
  f.per_load = 0.1;
  EXPECT_NEAR(steady_friction(f, 1.0, -20.0), 2.0, 1e-12);
  f = {};
  f.cold_coulomb_nm = 1.0;
  f.warming_s = 10.0;
  EXPECT_NEAR(steady_friction(f, 1.0, 0.0, 0.0, 10.0), std::exp(-1.0), 1e-12);
  f = {};
  f.worn_nm = 1.0;
  f.worn_position_rad = 0.5;
  EXPECT_NEAR(steady_friction(f, 1.0, 0.0, 0.5), 1.0, 1e-12);
  EXPECT_LT(steady_friction(f, 1.0, 0.0, 1.0), 1e-6);
}

TEST(Bristle, AReversalIsDoneBySixtyThreePercentWithinTheWidth) {
  const Bristle bristle(0.1, 0.0, 0.0);
  double stretch = 1.0;
  for (int i = 0; i < 100; ++i) stretch = bristle.advance(stretch, -2.0, 0.1 / 2.0 / 100.0);
  EXPECT_NEAR((1.0 - stretch) / 2.0, 1.0 - std::exp(-1.0), 1e-9);
  EXPECT_NEAR(bristle.advance(1.0, -2.0, 0.05), stretch, 1e-9);  // any step
  EXPECT_EQ(bristle.advance(0.3, 50.0, 1.0), 1.0);
}

TEST(HiddenPlant, EndStopAndContactPushBack) {
  Robot robot = bare_robot();
  robot.gravity_m_s2 = 0.0;
  robot.joints[0].loads.stop_nm_rad = 100.0;
  robot.joints[0].loads.stop_position_rad = 0.5;
  const Plant stopped(robot);
  PlantState free = stopped.start({0.49, 0.3}, {0.0, 0.0}),
             at_stop = stopped.start({0.6, 0.3}, {0.0, 0.0});
  stopped.step(free, 0.0, Vector2d::Zero(), kStepS);
  stopped.step(at_stop, 0.0, Vector2d::Zero(), kStepS);
  EXPECT_EQ(free.motor_dq[0], 0.0);
  EXPECT_LT(at_stop.motor_dq[0], 0.0);

  const Plant pushed(bare_robot(), {Contact{0, 1.0, 0.5, 8.0}});
  const Plant alone(bare_robot());
  for (const double t_s : {0.9, 1.25, 1.6}) {
    PlantState a = pushed.start({0.1, 0.3}, {0.0, 0.0}), b = a;
    pushed.step(a, t_s, Vector2d::Zero(), kStepS);
    alone.step(b, t_s, Vector2d::Zero(), kStepS);
    EXPECT_EQ(a.motor_dq[0] == b.motor_dq[0], t_s != 1.25);
  }
}

}  // namespace
}  // namespace offnominal::sim::hidden
