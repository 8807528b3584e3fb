// The paper's two faults, caught and compensated over the bus, with the readings that frames carry.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "arm_on_bus.hpp"
#include "paper/experiment.hpp"

namespace offnominal::test {
namespace {

struct BusRun {
  std::optional<double> detection_time_s;
  double tracking_rms_rad = 0;
};

BusRun run_over_bus(sim::FaultKind kind, bool accommodate, hal::FrameFormat format) {
  ArmOnBus arm({.kind = kind}, accommodate, format);
  BusRun run;
  if (!arm.start()) return run;
  arm.tick();  // the arming sample: time 0
  double sum = 0;
  int count = 0;
  for (int tick = 1; tick <= 20000; ++tick) {
    arm.tick();
    EXPECT_EQ(arm.data->state, hal::ControllerState::kArmed) << "tick " << tick;
    const auto& detector = arm.data->output.detector;
    if (detector.latched && !run.detection_time_s) {
      run.detection_time_s = detector.detection_time_s;
    }
    if (tick < 15000) continue;
    const auto desired = sim::paper_trajectory(0.001 * tick);
    sum += (desired.q - arm.plant().state().q).squaredNorm();
    ++count;
  }
  EXPECT_EQ(arm.data->missed_samples, 0U);
  EXPECT_EQ(arm.data->refused_frames, 0U);
  run.tracking_rms_rad = std::sqrt(sum / count);
  return run;
}

class OverTheBus : public testing::TestWithParam<std::tuple<sim::FaultKind, hal::FrameFormat>> {};

TEST_P(OverTheBus, DetectsAndAccommodatesAsThePaperRunDoes) {
  const auto [kind, format] = GetParam();
  desk::paper::Experiment experiment;
  experiment.fault.kind = kind;
  const auto paper = run_experiment(desk::paper::two_link_robot(), experiment);
  const BusRun watched = run_over_bus(kind, false, format);
  if (kind == sim::FaultKind::kNone) {
    EXPECT_FALSE(watched.detection_time_s.has_value());
    return;
  }
  ASSERT_TRUE(paper.detection_time_s.has_value());
  ASSERT_TRUE(watched.detection_time_s.has_value());
  EXPECT_NEAR(*watched.detection_time_s, *paper.detection_time_s, 0.1);
  EXPECT_GT(*watched.detection_time_s, 10.0) << "an alarm before the fault";
  const BusRun helped = run_over_bus(kind, true, format);
  EXPECT_LT(helped.tracking_rms_rad, 0.7 * watched.tracking_rms_rad);
}

INSTANTIATE_TEST_SUITE_P(
    Faults, OverTheBus,
    testing::Combine(testing::Values(sim::FaultKind::kNone, sim::FaultKind::kMassLoss,
                                     sim::FaultKind::kNonlinear),
                     testing::Values(hal::FrameFormat::kClassic, hal::FrameFormat::kFd)),
    [](const auto& fault) {
      return desk::paper::name_of(std::get<0>(fault.param)) +
             (std::get<1>(fault.param) == hal::FrameFormat::kFd ? "_fd" : "_classic");
    });

}  // namespace
}  // namespace offnominal::test
