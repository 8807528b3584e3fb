// Faults and accommodation that change while a run goes on.
#include "sil/both_ends.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "desk/sil/run_of_robot.hpp"
#include "desk/sil/serial_robot.hpp"
#include "paper/two_link_robot.hpp"

namespace offnominal::desk::sil {
namespace {

using sim::FaultEvent;
using sim::FaultEventKind;

struct Played {
  Played(const RobotDescription& robot, std::vector<FaultEvent> faults)
      : of(robot), scenario(scenario_of(of, std::move(faults))), ends(of, scenario, *wire, {}) {
    ends.start();
  }
  void until(double time_s) {
    while (ends.plant().time_s() < time_s - 1e-9) ends.tick();
  }
  [[nodiscard]] double q(int joint) const { return ends.plant().state().q[joint]; }

  RobotDescription of;
  Scenario scenario;
  std::unique_ptr<Wire> wire = make_in_process_wire();
  BothEnds ends;
};

std::vector<FaultEvent> all_sorts() {
  return {{.kind = FaultEventKind::kFrictionJump, .begin_s = 0.5, .joint = 1, .size = 1},
          {.kind = FaultEventKind::kPayload, .begin_s = 0.5, .size = 0.3},
          {.kind = FaultEventKind::kTorqueLoss, .begin_s = 0.5, .joint = 0, .size = 0.1},
          {.kind = FaultEventKind::kEncoderBias, .begin_s = 0.5, .joint = 2, .size = 0.01},
          {.kind = FaultEventKind::kFrameLoss, .begin_s = 0.5, .size = 0.02}};
}

// Told beforehand or on the way: not a bit differs.
TEST(BothEnds, TakesFaultsOnTheWayAsAScenarioHasThem) {
  const RobotDescription robot = test::by_joint_robot(3, 0.5);
  Played told(robot, all_sorts());
  Played injected(robot, {});
  injected.until(0.4);
  ASSERT_TRUE(injected.ends.set_faults(all_sorts()));
  injected.until(1.5);
  told.until(1.5);
  EXPECT_EQ(told.ends.plant().state().q, injected.ends.plant().state().q);
  EXPECT_EQ(told.ends.plant().state().dq, injected.ends.plant().state().dq);
  EXPECT_EQ(told.ends.controller().view().psi_hat, injected.ends.controller().view().psi_hat);
}

TEST(BothEnds, IsHealthyAgainWhereFaultsEnd) {
  const RobotDescription robot = test::by_joint_robot(3, 0.5);
  Played run(robot, {{.kind = FaultEventKind::kPayload, .begin_s = 0, .size = 0.5}});
  run.until(0.5);
  ASSERT_TRUE(run.ends.set_faults({}));
  run.until(3);
  const sim::JointVector tau = run.ends.plant().applied_nm();
  EXPECT_EQ(run.ends.plant().plant().fault_function(3, tau), sim::JointVector::Zero(3));
  // The controller, which has no integrator, tracks as well as ever.
  Played healthy(robot, {});
  healthy.until(3);
  EXPECT_NEAR(run.q(1), healthy.q(1), 1e-3);
}

TEST(BothEnds, RefusesFaultsOfThePapersArmOnTheWay) {
  const RobotDescription robot = paper::two_link_robot();
  const Scenario scenario;
  const auto wire = make_in_process_wire();
  BothEnds ends(robot, scenario, *wire, {});
  EXPECT_FALSE(ends.set_faults({{.kind = FaultEventKind::kPayload, .size = 1}}));
}

TEST(BothEnds, AccommodatesFromTheTickOnThatItIsTold) {
  const RobotDescription robot = test::by_joint_robot(3, 0.5);
  const std::vector<FaultEvent> push = {
      {.kind = FaultEventKind::kDisturbanceTorque, .begin_s = 0.5, .joint = 1, .size = 3}};
  Played without(robot, push);
  Played with(robot, push);
  for (Played* run : {&without, &with}) run->until(1.5);
  EXPECT_EQ(without.q(1), with.q(1));
  with.ends.controller().set_accommodation(true);
  for (Played* run : {&without, &with}) run->until(4);
  Played healthy(robot, {});
  healthy.until(4);
  const double off = std::abs(without.q(1) - healthy.q(1));
  EXPECT_GT(off, 0.01);
  EXPECT_LT(std::abs(with.q(1) - healthy.q(1)), 0.5 * off);
}

}  // namespace
}  // namespace offnominal::desk::sil
