// The two plants of the simulator behind their one face, and the end of the bus that moves them.
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <offnominal/hal/bus/in_process_bus.hpp>
#include <offnominal/hal/protocols/protected/protected_drives.hpp>
#include <set>
#include <stdexcept>

#include "offnominal/sim/bus/faulty_bus.hpp"
#include "offnominal/sim/bus/joint_drives.hpp"
#include "offnominal/sim/bus/plant_node.hpp"
#include "offnominal/sim/plants/hidden_robot.hpp"
#include "offnominal/sim/plants/paper_arm.hpp"

namespace offnominal::sim {
namespace {

using Eigen::Vector2d;

TEST(PaperArm, MovesAsItsEquations) {
  const Fault fault{.kind = FaultKind::kNonlinear, .time_s = 0.002};
  const TwoLinkPlant equations({}, fault, paper_uncertainty());
  TwoLinkState state{{0.1, -0.2}, {0.4, 0.5}};
  PaperArm arm(equations, {state.q, state.dq}, 2);
  EXPECT_EQ(arm.joint_count(), 2);
  for (int tick = 0; tick < 5; ++tick) {
    const double t_s = 0.001 * tick;
    const Vector2d tau(3.0 + tick, -1.0);
    EXPECT_EQ(arm.fault_function(t_s, tau), equations.fault_function(t_s, state, tau));
    state = equations.step(t_s, state, tau, 0.001, 2);
    arm.step(t_s, tau, 0.001);
    EXPECT_EQ(arm.state().q, state.q);
    EXPECT_EQ(arm.state().dq, state.dq);
  }
}

hidden::Robot a_hidden_robot() {
  hidden::Robot robot;
  robot.links = {{{1.0, 0.4, 0.2, 0.01}, {1.0, 0.4, 0.2, 0.01}}};
  return robot;
}

const DesiredMotion kAtRest{Vector2d(0.2, 0.3), Vector2d(0, 0), Vector2d(0, 0)};

// GIVEN a drive that is late and gives less WHEN its torque jumps THEN the joint feels nothing for
// so long, and then that share.
TEST(HiddenRobot, GivesWhatItsDrivesMakeOfATorque) {
  hidden::Robot robot = a_hidden_robot();
  robot.joints[0].drive = {.scale = 0.5, .delay_s = 0.003};
  HiddenRobot plant(robot, {}, kAtRest);
  plant.step(0.0, Vector2d(2.0, 1.0), 0.001);
  EXPECT_DOUBLE_EQ(plant.given_nm()[0], 1.0);
  EXPECT_DOUBLE_EQ(plant.given_nm()[1], 1.0);
  for (int tick = 1; tick <= 3; ++tick) {
    plant.step(0.001 * tick, Vector2d(4.0, 3.0), 0.001);
    EXPECT_DOUBLE_EQ(plant.given_nm()[0], 1.0) << tick;
    EXPECT_DOUBLE_EQ(plant.given_nm()[1], 3.0) << tick;
  }
  plant.step(0.004, Vector2d(4.0, 3.0), 0.001);
  EXPECT_DOUBLE_EQ(plant.given_nm()[0], 2.0);
  EXPECT_EQ(plant.fault_function(0.0, Vector2d(1, 1)), Vector2d(0, 0));
}

// What the encoders see of a soft joint is its motor.
TEST(HiddenRobot, HasItsEncodersAtTheMotors) {
  hidden::Robot robot = a_hidden_robot();
  robot.joints[1].transmission.stiffness_nm_rad = 200.0;
  HiddenRobot plant(robot, {}, kAtRest);
  plant.step(0.0, Vector2d(5.0, 5.0), 0.001);
  EXPECT_EQ(plant.state().q, plant.inner_state().motor_q);
  EXPECT_NE(plant.state().q[1], plant.inner_state().link_q[1]);
}

// Joints without mass at all: a torque is a velocity.
class Straw final : public Plant {
 public:
  explicit Straw(Eigen::Index joints)
      : state_{JointVector::Zero(joints), JointVector::Zero(joints)} {}
  [[nodiscard]] const JointState& state() const override { return state_; }
  void step(double /*t_s*/, const JointVector& tau, double period_s) override {
    state_.dq = tau;
    state_.q += period_s * tau;
  }
  [[nodiscard]] JointVector fault_function(double /*t_s*/, const JointVector& tau) const override {
    return JointVector::Zero(tau.size());
  }

 private:
  JointState state_;
};

// The plant's end of a bus with as many joints as there may be, and a controller's frames.
template <std::size_t Joints>
struct Bench {
  explicit Bench(const PlantNodeConfig& config,
                 hal::FrameFormat format = hal::FrameFormat::kClassic)
      : node(std::make_unique<Straw>(static_cast<Eigen::Index>(Joints)),
             std::make_unique<JointDrives>(Joints, DriveConfig{}, format), config),
        drives({}, {}, format) {}

  void tick() {
    now_us += 1000;
    net.set_time(now_us);
    std::array<hal::TorqueCommand, Joints> commands;
    for (std::size_t j = 0; j < Joints; ++j) {
      commands[j] = {hal::DriveMode::kTorque, static_cast<float>(j + 1)};
    }
    std::array<hal::Frame, Joints + 1> frames;
    const std::size_t count = drives.outgoing(commands, {}, frames);
    for (std::size_t i = 0; i < count; ++i) {
      static_cast<void>(controller.send(frames[i], now_us + 1000));
    }
    node.tick(now_us + 1000, plant);
    std::array<hal::ReceivedFrame, 2 * Joints> come;
    const std::size_t arrived = controller.receive(come);
    for (std::size_t i = 0; i < arrived; ++i) static_cast<void>(drives.take(come[i]));
  }

  hal::InProcessNet<2> net;
  hal::InProcessNet<2>::Port controller = net.port(0);
  hal::InProcessNet<2>::Port plant = net.port(1);
  PlantNode node;
  hal::ProtectedDrives<Joints> drives;
  hal::Microseconds now_us = 0;
};

TEST(PlantNode, SpeaksForAsManyJointsAsThereMayBe) {
  constexpr auto kMost = static_cast<std::size_t>(kMaxJoints);
  for (const auto format : {hal::FrameFormat::kClassic, hal::FrameFormat::kFd}) {
    Bench<kMost> bench({}, format);
    for (int i = 0; i < 5; ++i) bench.tick();
    EXPECT_TRUE(bench.node.started());
    for (std::size_t j = 0; j < kMost; ++j) {
      const hal::JointFeedback joint = bench.drives.feedback(j, bench.now_us);
      EXPECT_EQ(joint.encoder, hal::SourceState::kValid) << j;
      EXPECT_EQ(joint.status.applied_torque, static_cast<float>(j + 1));
      EXPECT_NEAR(joint.reading.position, bench.node.state().q[static_cast<Eigen::Index>(j)], 1e-5);
      EXPECT_GT(joint.reading.position, 0.002F) << j;
    }
  }
}

// GIVEN a drive that loses torque and a push on its joint WHEN it is told to give torque THEN less
// and more acts, and it says what it means to give.
TEST(PlantNode, TorqueThatIsLostOrPushesIsNotWhatTheDriveSays) {
  Bench<3> bench(
      {.faults = {{.kind = FaultEventKind::kDisturbanceTorque, .begin_s = 0, .joint = 2, .size = 5},
                  {.kind = FaultEventKind::kTorqueLoss, .begin_s = 0, .joint = 2, .size = 0.5}}});
  for (int i = 0; i < 5; ++i) bench.tick();
  EXPECT_EQ(bench.node.applied_nm(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(bench.node.acting_nm(), Eigen::Vector3d(1, 2, 6.5));
}

// A joint that turns on and on says where it is modulo ten turns.
TEST(PlantNode, CarriesThePositionOfAJointThatTurnsOnAndOn) {
  Bench<2> bench({.period_s = 10.0, .turns_on = {true, false}});
  for (int i = 0; i < 6; ++i) bench.tick();
  ASSERT_GT(bench.node.state().q[0], 31.5);
  EXPECT_NEAR(bench.drives.feedback(0, bench.now_us).reading.position,
              hal::carried_position(bench.node.state().q[0]), 1e-4);
  // The other's position is one that no frame can say.
  EXPECT_NE(bench.drives.feedback(1, bench.now_us).encoder, hal::SourceState::kValid);
}

TEST(PlantNode, RefusesAFaultOfAJointThatItHasNot) {
  const PlantNodeConfig config{
      .faults = {{.kind = FaultEventKind::kEncoderStuck, .begin_s = 0, .joint = 3}}};
  const auto drives = [](std::size_t joints) {
    return std::make_unique<JointDrives>(joints, DriveConfig{}, hal::FrameFormat::kClassic);
  };
  const auto straw = [] { return std::make_unique<Straw>(3); };
  EXPECT_THROW(PlantNode(straw(), drives(3), config), std::invalid_argument);
  EXPECT_THROW(PlantNode(nullptr, drives(3), {}), std::invalid_argument);
  EXPECT_THROW(PlantNode(straw(), nullptr, {}), std::invalid_argument);
  EXPECT_THROW(PlantNode(straw(), drives(2), {}), std::invalid_argument);
  EXPECT_NO_THROW(PlantNode(straw(), drives(3), {}));
}

TEST(JointDrives, AreOfOneToTwelveJoints) {
  EXPECT_THROW(JointDrives(0, {}, hal::FrameFormat::kFd), std::invalid_argument);
  EXPECT_THROW(JointDrives(kMaxJoints + 1, {}, hal::FrameFormat::kFd), std::invalid_argument);
  EXPECT_EQ(JointDrives(kMaxJoints, {}, hal::FrameFormat::kFd).joints(), std::size_t{kMaxJoints});
}

// Somebody who forges frames forges those of every joint.
TEST(FaultyBus, ForgesFramesOfEveryJoint) {
  hal::InProcessNet<2> net;
  auto inner = net.port(1);
  auto listener = net.port(0);
  const JointDrives drives(6, {}, hal::FrameFormat::kClassic);
  FaultyBus bus(inner, BusEnd::kPlant, drives,
                {{.kind = FaultEventKind::kForgedFrames, .begin_s = 0, .size = 64}}, 1);
  bus.set_time(0.5);
  std::array<hal::ReceivedFrame, 64> frames;
  const std::size_t count = listener.receive(frames);
  ASSERT_EQ(count, frames.size());
  std::set<std::uint32_t> ids;
  for (const hal::ReceivedFrame& frame : frames) ids.insert(frame.frame.id);
  EXPECT_EQ(ids.size(), 6U);
  EXPECT_EQ(*ids.rbegin(), hal::id_of(hal::MessageKind::kEncoder, 5));
}

}  // namespace
}  // namespace offnominal::sim
