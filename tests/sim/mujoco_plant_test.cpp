// A robot of MuJoCo behind the plants' one face.
#include "offnominal/sim/plants/mujoco_plant.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

namespace offnominal::sim {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

// Three links about axes of their own; `joint`: attributes of every joint, `last`: mass of the last
// link, kg, at its place along x, m.
std::string arm_text(const std::string& joint = "", double last_kg = 1, double last_at_m = 0.2) {
  const std::string last = std::to_string(last_kg);
  return R"(<mujoco><compiler angle="radian" inertiafromgeom="false"/>
<option gravity="0 0 -9.81"/><worldbody>
<body name="a" pos="0 0 1"><inertial pos="0.05 0.02 0.1" mass="3" fullinertia="0.04 0.05 0.03 0.002 0.001 -0.003"/>
<joint name="one" type="hinge" axis="0 0 1" )" +
         joint + R"(/>
<body name="b" pos="0.1 0 0.2"><inertial pos="0.2 0 0" mass="2" diaginertia="0.01 0.03 0.03"/>
<joint name="two" type="hinge" axis="0 1 0" )" +
         joint + R"(/>
<body name="c" pos="0.4 0 0"><inertial pos=")" +
         std::to_string(last_at_m) + R"( 0 0" mass=")" + last + R"(" diaginertia="0.004 0.01 0.01"/>
<joint name="three" type="hinge" axis="0 1 0" )" +
         joint + R"(/>
</body></body></body></worldbody></mujoco>)";
}

// A mass that slides along x without gravity.
std::string sledge_text(const std::string& joint = "") {
  return R"(<mujoco><option gravity="0 0 0"/><worldbody><body name="s">
<inertial pos="0 0 0" mass="2" diaginertia="1 1 1"/><joint name="rail" type="slide" axis="1 0 0" )" +
         joint + "/></body></worldbody></mujoco>";
}

JointState at_rest(Eigen::Index joints) {
  return {JointVector::Zero(joints), JointVector::Zero(joints)};
}
JointState swinging() { return {Vector3d(0.3, -0.4, 0.8), Vector3d(1.5, 0.5, -1)}; }

MujocoPlant arm(const std::string& text, const MujocoSetup& setup) {
  return {MujocoModel::from_text(text), setup};
}

TEST(MujocoModel, NamesItsJointsAndWhatTheyHave) {
  const auto joints =
      MujocoModel::from_text(arm_text("frictionloss='0.5' damping='0.25' armature='0.125'"))
          .joints();
  ASSERT_EQ(joints.size(), 3U);
  EXPECT_EQ(joints[1].name, "two");
  EXPECT_TRUE(joints[1].turns);
  EXPECT_EQ(joints[1].friction_loss, 0.5);
  EXPECT_EQ(joints[1].damping, 0.25);
  EXPECT_EQ(joints[1].armature, 0.125);
  EXPECT_FALSE(MujocoModel::from_text(sledge_text()).joints().front().turns);
}

TEST(MujocoModel, ReadsAUrdf) {
  const auto joints = MujocoModel::from_text(R"(<robot name="r"><link name="base"/>
<link name="l"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="revolute"><parent link="base"/><child link="l"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="5" velocity="1"/></joint></robot>)")
                          .joints();
  ASSERT_EQ(joints.size(), 1U);
  EXPECT_EQ(joints.front().name, "j");
}

std::string refusal_of(const std::string& text) {
  try {
    static_cast<void>(MujocoModel::from_text(text));
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(MujocoModel, RefusesWhatIsNoRobot) {
  EXPECT_THAT(refusal_of("<mujoco><worldbody><body></worldbody></mujoco>"),
              HasSubstr("XML parse error"));
  EXPECT_THAT(refusal_of("<mujoco><worldbody/></mujoco>"), HasSubstr("no joint"));
  EXPECT_THAT(refusal_of("<mujoco><worldbody><body><joint name='b' type='ball'/>"
                         "<geom size='0.1'/></body></worldbody></mujoco>"),
              HasSubstr("joint b has more than one axis"));
  EXPECT_THROW(static_cast<void>(MujocoModel::from_file("/nowhere/robot.xml")), std::runtime_error);
}

// GIVEN no friction and no torque WHEN it swings THEN its energy stays.
TEST(MujocoPlant, KeepsItsEnergyWithoutFriction) {
  MujocoPlant plant =
      arm(arm_text(), {.start = swinging(), .integrator = MujocoIntegrator::kRungeKutta4});
  const double before = plant.energy_j();
  const double first = plant.state().q[1];
  for (int tick = 0; tick < 3000; ++tick) plant.step(0.001 * tick, Vector3d::Zero(), 0.001);
  EXPECT_NEAR(plant.energy_j(), before, 1e-6);
  EXPECT_GT(std::abs(plant.state().q[1] - first), 0.1);
}

TEST(MujocoPlant, LosesNoMoreEnergyToItsStepThanTheStepIsLong) {
  MujocoPlant plant = arm(arm_text(), {.start = swinging()});
  const double before = plant.energy_j();
  for (int tick = 0; tick < 3000; ++tick) plant.step(0.001 * tick, Vector3d::Zero(), 0.001);
  EXPECT_NEAR(plant.energy_j(), before, 0.05);
}

// GIVEN the torques that a motion takes WHEN the plant is given them THEN it moves so.
TEST(MujocoPlant, MovesAsItsInverseDynamicsSays) {
  MujocoPlant plant = arm(arm_text("damping='0.3' armature='0.02'"),
                          {.start = swinging(), .longest_substep_s = 1e-5});
  const Vector3d ddq(0.7, -1.1, 2);
  const JointState start = swinging();
  const JointVector tau = plant.inverse_dynamics({start.q, start.dq, ddq});
  plant.step(0, tau, 1e-5);
  EXPECT_LT((Vector3d((plant.state().dq - start.dq) / 1e-5) - ddq).norm(), 2e-3);
}

TEST(MujocoPlant, GivesTheSameBitsForTheSameSteps) {
  const auto run = [] {
    MujocoPlant plant = arm(arm_text("frictionloss='0.4' damping='0.1'"), {.start = swinging()});
    for (int tick = 0; tick < 500; ++tick) {
      if (tick == 100) plant.set_payload(2, 0.3, {0.1, 0.05, 0});
      plant.push(1, {0, tick > 200 ? 5.0 : 0.0, 0}, {0.1, 0, 0});
      plant.step(0.001 * tick, Vector3d(std::sin(0.02 * tick), 8, 1), 0.001);
    }
    return plant.state();
  };
  const JointState once = run();
  const JointState again = run();
  EXPECT_EQ(once.q, again.q);
  EXPECT_EQ(once.dq, again.dq);
}

// GIVEN dry friction above the weight WHEN nothing drives it THEN it stands; below, it falls.
TEST(MujocoPlant, FrictionLossHoldsItAtRest) {
  MujocoPlant plant = arm(arm_text("frictionloss='30'"), {.start = at_rest(3)});
  for (int tick = 0; tick < 1000; ++tick) plant.step(0.001 * tick, Vector3d::Zero(), 0.001);
  EXPECT_LT(plant.state().q.cwiseAbs().maxCoeff(), 1e-5);
  plant.set_friction_loss(1, 5);
  for (int tick = 0; tick < 300; ++tick) plant.step(1 + 0.001 * tick, Vector3d::Zero(), 0.001);
  EXPECT_GT(std::abs(plant.state().q[1]), 0.05);
}

TEST(MujocoPlant, FrictionLossAndDampingSlowASledgeAsTheySay) {
  MujocoPlant dry =
      arm(sledge_text("frictionloss='3'"), {.start = {JointVector::Zero(1), JointVector::Ones(1)}});
  MujocoPlant wet =
      arm(sledge_text("damping='0.5'"), {.start = {JointVector::Zero(1), JointVector::Ones(1)}});
  for (int tick = 0; tick < 400; ++tick) {
    dry.step(0.001 * tick, JointVector::Zero(1), 0.001);
    wet.step(0.001 * tick, JointVector::Zero(1), 0.001);
  }
  EXPECT_NEAR(dry.state().dq[0], 1 - 0.4 * 3 / 2, 2e-3);
  EXPECT_NEAR(dry.gear_torque()[0], -3, 1e-3);
  EXPECT_NEAR(wet.state().dq[0], std::exp(-0.4 * 0.5 / 2), 1e-4);
}

// GIVEN a payload hung on WHEN asked for torques THEN they are those of the arm that has it.
TEST(MujocoPlant, CarriesAPayloadAsAHeavierLinkDoes) {
  MujocoPlant plant = arm(arm_text(), {.start = swinging()});
  plant.set_payload(2, 1.5, {0.2, 0, 0});  // at the link's own centre of mass
  const MujocoPlant heavier = arm(arm_text("", 2.5), {.start = swinging()});
  const DesiredMotion motion{Vector3d(0.2, 0.5, -1), Vector3d(1, 2, -0.5), Vector3d(3, -2, 1)};
  EXPECT_LT((plant.inverse_dynamics(motion) - heavier.inverse_dynamics(motion)).norm(), 1e-9);
  plant.set_payload(2, 0, {0, 0, 0});
  const MujocoPlant bare = arm(arm_text(), {.start = swinging()});
  EXPECT_LT((plant.inverse_dynamics(motion) - bare.inverse_dynamics(motion)).norm(), 1e-9);
}

// GIVEN faults that begin WHEN their time comes THEN the motion differs from then on, not before.
TEST(MujocoPlant, ShowsAFaultAtItsTimeAndNotBefore) {
  for (const FaultEvent& fault :
       {FaultEvent{.kind = FaultEventKind::kPayload, .begin_s = 0.05, .size = 0.8},
        FaultEvent{.kind = FaultEventKind::kMassLoss, .begin_s = 0.05, .joint = 1, .size = 0.5},
        FaultEvent{
            .kind = FaultEventKind::kFrictionJump, .begin_s = 0.05, .joint = 0, .size = 2}}) {
    SCOPED_TRACE(info_of(fault.kind).name);
    MujocoPlant healthy = arm(arm_text(), {.start = swinging()});
    MujocoPlant faulty = arm(arm_text(), {.start = swinging(), .faults = {fault}});
    const Vector3d tau(0.1, 5, 2);
    for (int tick = 0; tick < 50; ++tick) {
      EXPECT_EQ(faulty.fault_function(0.001 * tick, tau), Vector3d::Zero());
      healthy.step(0.001 * tick, tau, 0.001);
      faulty.step(0.001 * tick, tau, 0.001);
      ASSERT_EQ(healthy.state().q, faulty.state().q) << tick;
    }
    const JointVector expected = faulty.fault_function(0.05, tau);
    EXPECT_GT(expected.norm(), 0.1);
    faulty.step(0.05, tau, 0.0005);
    healthy.step(0.05, tau, 0.0005);
    const JointVector differs = (faulty.state().dq - healthy.state().dq) / 0.0005;
    EXPECT_LT((differs - expected).norm(), 0.02 * expected.norm());
  }
}

// GIVEN faults that act WHEN it is given others THEN it has those, and nothing of the ones before.
TEST(MujocoPlant, HasTheFaultsItWasLastGivenAndNothingOfOthers) {
  const FaultEvent payload{.kind = FaultEventKind::kPayload, .begin_s = 0, .size = 0.8};
  const FaultEvent loss{.kind = FaultEventKind::kMassLoss, .begin_s = 0, .joint = 1, .size = 0.5};
  const FaultEvent jump{.kind = FaultEventKind::kFrictionJump, .begin_s = 0, .joint = 0, .size = 2};
  const Vector3d tau(0.1, 5, 2);
  // Where it goes next from one state, after a step with the first faults.
  const auto moved = [&](const std::vector<FaultEvent>& first,
                         const std::vector<FaultEvent>& then) -> JointVector {
    MujocoPlant plant = arm(arm_text(), {.start = swinging(), .faults = first});
    constexpr double kHardlyS = 1e-9;
    plant.step(0.1, tau, kHardlyS);
    EXPECT_TRUE(plant.set_faults(then));
    if (then.empty()) {
      const DesiredMotion motion{Vector3d(0.2, 0.5, -1), Vector3d(1, 2, -0.5), Vector3d(3, -2, 1)};
      const MujocoPlant bare = arm(arm_text(), {.start = swinging()});
      EXPECT_EQ(plant.inverse_dynamics(motion), bare.inverse_dynamics(motion));
    }
    plant.step(0.2, tau, 0.001);
    return plant.state().dq;
  };
  const JointVector healthy = moved({}, {});
  for (const FaultEvent& fault : {payload, loss, jump}) {
    SCOPED_TRACE(info_of(fault.kind).name);
    EXPECT_LT((moved({fault}, {}) - healthy).norm(), 1e-6);
    EXPECT_LT((moved({}, {fault}) - moved({fault}, {fault})).norm(), 1e-6);
    EXPECT_GT((moved({}, {fault}) - healthy).norm(), 1e-4);
  }
  FaultEvent half = payload;
  half.size = 0.4;
  EXPECT_LT((moved({}, {half, half}) - moved({}, {payload})).norm(), 1e-9);
  // Two losses of one link: half of what the first has left.
  FaultEvent both = loss;
  both.size = 0.75;
  EXPECT_LT((moved({}, {loss, loss}) - moved({}, {both})).norm(), 1e-9);
}

TEST(MujocoPlant, RefusesAFaultOfAJointThatItHasNot) {
  MujocoPlant plant = arm(arm_text(), {.start = swinging()});
  EXPECT_THROW(static_cast<void>(plant.set_faults(
                   {{.kind = FaultEventKind::kFrictionJump, .joint = 3, .size = 1}})),
               std::invalid_argument);
}

TEST(MujocoPlant, IsPushedAsMuchAsTheForceSays) {
  MujocoPlant sledge = arm(sledge_text(), {.start = at_rest(1)});
  sledge.push(0, {4, 1, 0}, {0, 0, 0});
  for (int tick = 0; tick < 100; ++tick) sledge.step(0.001 * tick, JointVector::Zero(1), 0.001);
  EXPECT_NEAR(sledge.state().dq[0], 0.1 * 4 / 2, 1e-9);
  sledge.push(0, {0, 0, 0}, {0, 0, 0});
  sledge.step(0.1, JointVector::Zero(1), 0.1);
  EXPECT_NEAR(sledge.state().dq[0], 0.1 * 4 / 2, 1e-9);

  // A force down on the last link's end is the torque of its lever on the joints before.
  MujocoPlant plant = arm(arm_text(), {.start = at_rest(3), .longest_substep_s = 1e-5});
  const JointVector holding =
      plant.inverse_dynamics({JointVector::Zero(3), JointVector::Zero(3), JointVector::Zero(3)});
  plant.push(2, {0, 0, -10}, {0.5, 0, 0});
  const JointVector lever = Vector3d(0, 10 * 0.9, 10 * 0.5);
  plant.step(0, holding - lever, 1e-3);
  EXPECT_LT(plant.state().dq.norm(), 1e-6);
}

TEST(MujocoPlant, RefusesAStartOrAFaultOfAnotherRobot) {
  const auto model = MujocoModel::from_text(arm_text());
  EXPECT_THROW(MujocoPlant(model, {.start = at_rest(2)}), std::invalid_argument);
  EXPECT_THROW(
      MujocoPlant(model, {.start = at_rest(3),
                          .faults = {{.kind = FaultEventKind::kFrictionJump, .joint = 8}}}),
      std::invalid_argument);
  EXPECT_THROW(MujocoPlant(model, {.start = at_rest(3), .longest_substep_s = 0}),
               std::invalid_argument);
}

TEST(MujocoPlant, SaysThatItsMotionHasRunAway) {
  MujocoPlant plant = arm(sledge_text(), {.start = at_rest(1)});
  EXPECT_THROW(plant.step(0, JointVector::Constant(1, 1e16), 0.01), std::runtime_error);
}

}  // namespace
}  // namespace offnominal::sim
