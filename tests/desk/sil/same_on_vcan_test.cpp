// Lock-step over the kernel's bus gives what the in-process bus gives, bit for bit.
#include <gtest/gtest.h>

#include <future>
#include <nlohmann/json.hpp>
#include <string>

#include "desk/sil/serial_robot.hpp"
#include "paper/two_link_robot.hpp"
#include "sil/sil.hpp"
#include "sil/sil_report.hpp"

namespace offnominal::desk::sil {
namespace {

struct Outcome {
  nlohmann::ordered_json json;
  paper::TimeSeries series;
};

Outcome outcome(Scenario scenario, Wire& wire) {
  scenario.record = true;
  const RobotDescription robot = scenario.plant ? *scenario.plant : paper::two_link_robot();
  SilResult result = run_in_lock_step(robot, scenario, wire, "either");
  Outcome outcome{to_json(result), std::move(result.run.series)};
  return outcome;
}

void expect_same(const Outcome& on_bus, const Outcome& alone) {
  EXPECT_EQ(on_bus.json, alone.json);
  EXPECT_EQ(on_bus.series.q, alone.series.q);
  EXPECT_EQ(on_bus.series.tau, alone.series.tau);
  EXPECT_EQ(on_bus.series.psi_hat, alone.series.psi_hat);
  EXPECT_EQ(on_bus.series.error_norm, alone.series.error_norm);
}

void expect_same(const Scenario& scenario, const std::string& bus) {
  expect_same(outcome(scenario, *make_socketcan_wire(bus)),
              outcome(scenario, *make_in_process_wire()));
}

class PaperFaults : public testing::TestWithParam<sim::FaultEventKind> {};

// Without accommodation on one bus, at the same time with it on the other: neither is in a hurry.
TEST_P(PaperFaults, GiveTheSameRunOnVcan) {
  Scenario scenario;
  scenario.faults = {{.kind = GetParam(), .begin_s = 10, .size = 0.75, .rate_per_s = 0.5}};
  auto watching = std::async(std::launch::async, [&] { expect_same(scenario, "vcan0"); });
  Scenario accommodated = scenario;
  accommodated.accommodate = true;
  expect_same(accommodated, "vcan1");
  watching.get();
}

INSTANTIATE_TEST_SUITE_P(Vcan, PaperFaults,
                         testing::Values(sim::FaultEventKind::kMassLoss,
                                         sim::FaultEventKind::kNonlinear));

TEST(SameOnVcan, WithFaultsOfTheBusAndCanFd) {
  Scenario scenario;
  scenario.duration_s = 1.0;
  scenario.format = hal::FrameFormat::kFd;
  scenario.faults = {{.kind = sim::FaultEventKind::kFrameLoss, .begin_s = 0.3, .size = 0.05},
                     {.kind = sim::FaultEventKind::kBabblingNode, .begin_s = 0.5, .size = 4}};
  expect_same(scenario, "vcan0");
}

// One joint in classic frames, more in CAN FD, and a fault of the last one.
TEST(SameOnVcan, WithOneFourSixAndSevenJoints) {
  for (const int joints : {1, 4, 6, 7}) {
    Scenario scenario;
    scenario.duration_s = 0.5;
    scenario.plant = test::serial_robot(joints);
    scenario.faults = {{.kind = sim::FaultEventKind::kDisturbanceTorque,
                        .begin_s = 0.25,
                        .joint = joints - 1,
                        .size = 5}};
    expect_same(scenario, "vcan0");
  }
}

TEST(SameOnVcan, WithTwoAndSevenOdrives) {
  for (const int joints : {2, 7}) {
    Scenario scenario;
    scenario.duration_s = 0.5;
    scenario.plant = test::odrive_robot(joints, joints == 2 ? 1 : 5, "0.6");
    expect_same(scenario, "vcan0");
  }
}

}  // namespace
}  // namespace offnominal::desk::sil
