// The firmware on an emulated Cortex-M against the same source on this machine, tick by tick.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "desk/support/temporary_folder.hpp"
#include "offnominal/sim/fault.hpp"
#include "paper/experiment.hpp"
#include "paper/two_link_robot.hpp"
#include "qemu.hpp"
#include "recorded_run.hpp"

namespace offnominal::test {
namespace {

using cortex_m::ReplayFrame;
using cortex_m::ReplayResult;
using cortex_m::ReplayTick;

template <typename Scalar>
std::vector<ReplayResult> on_host(const std::vector<ReplayTick>& run) {
  cortex_m::ReplayRun<Scalar> replay;
  EXPECT_EQ(replay.start(), Status::kOk);
  std::vector<ReplayResult> results(run.size());
  for (std::size_t i = 0; i < run.size(); ++i) replay.tick(run[i], results[i]);
  return results;
}

std::vector<ReplayResult> on_target(const Board& board, const std::string& scalar,
                                    const std::vector<ReplayTick>& run) {
  const TemporaryFolder folder;
  const std::string input = (folder / "in").string();
  const std::string output = (folder / "out").string();
  std::ofstream(input, std::ios::binary)
      .write(reinterpret_cast<const char*>(run.data()),
             static_cast<std::streamsize>(run.size() * sizeof(ReplayTick)));
  const int code =
      run_on(board, "offnominal_replay_" + scalar, {std::to_string(run.size()), input, output});
  EXPECT_EQ(code, 0) << "exit code, see targets/cortex_m/firmware/replay.cpp";
  std::vector<ReplayResult> results(run.size());
  std::ifstream file(output, std::ios::binary);
  const auto size = static_cast<std::streamsize>(results.size() * sizeof(ReplayResult));
  file.read(reinterpret_cast<char*>(results.data()), size);
  EXPECT_EQ(file.gcount(), size) << "results of every tick";
  return results;
}

// The torque of a frame that the controller has sent; NaN where it carries none.
double torque_of(const ReplayFrame& frame) {
  hal::TorqueCommand command;
  std::uint8_t counter = 0;
  const auto node =
      static_cast<std::uint8_t>(frame.id - hal::id_of(hal::MessageKind::kTorqueCommand, 0));
  const bool open = frame.length == hal::kRecordLength &&
                    decode(std::span<const std::uint8_t, hal::kRecordLength>(frame.data),
                           hal::data_id_of(hal::MessageKind::kTorqueCommand, node), command,
                           counter) == hal::Status::kOk;
  return open ? static_cast<double>(command.torque) : std::nan("");
}

// The largest difference, each against the largest that the number ever is.
struct Differences {
  double error_norm = 0, threshold = 0, psi_hat = 0, torque = 0;
};

// NaN, which fmax drops, is the worst of all.
double worse(double a, double b) {
  return std::isnan(a) || std::isnan(b) ? std::nan("") : std::fmax(a, b);
}

template <typename Number>
double largest_difference(const std::vector<ReplayResult>& a, const std::vector<ReplayResult>& b,
                          const Number& number) {
  double difference = std::nan("");  // where no tick has the number
  double size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double x = number(a[i]);
    const double y = number(b[i]);
    if (std::isnan(x) != std::isnan(y)) return std::nan("");
    if (std::isnan(x)) continue;
    difference = std::fmax(difference, std::fabs(x - y));
    size = std::fmax(size, std::fabs(x));
  }
  return size > 0 ? difference / size : difference;
}

Differences differences(const std::vector<ReplayResult>& a, const std::vector<ReplayResult>& b) {
  Differences all;
  all.error_norm = largest_difference(a, b, [](const ReplayResult& r) { return r.error_norm; });
  all.threshold = largest_difference(a, b, [](const ReplayResult& r) { return r.threshold; });
  for (std::size_t j = 0; j < cortex_m::kReplayJoints; ++j) {
    const double psi =
        largest_difference(a, b, [j](const ReplayResult& r) { return r.psi_hat[j]; });
    const double torque =
        largest_difference(a, b, [j](const ReplayResult& r) { return torque_of(r.sent[j]); });
    all.psi_hat = worse(all.psi_hat, psi);
    all.torque = worse(all.torque, torque);
  }
  return all;
}

struct Case {
  Board board;
  const char* scalar;
  sim::FaultKind fault;
};

class Firmware : public testing::TestWithParam<Case> {};

TEST_P(Firmware, GivesTheHostsResultsOnThePapersRun) {
  const auto [board, scalar, fault] = GetParam();
  const bool is_float = std::string(scalar) == "float";
  const std::vector<ReplayTick> run = recorded_run(fault);
  const std::vector<ReplayResult> host = is_float ? on_host<float>(run) : on_host<double>(run);
  const std::vector<ReplayResult> target = on_target(board, scalar, run);

  for (std::size_t i = 0; i < run.size(); ++i) {
    ASSERT_EQ(target[i].state, host[i].state) << "tick " << i;
    ASSERT_EQ(target[i].fault, host[i].fault) << "tick " << i;
    ASSERT_EQ(target[i].sent_count, host[i].sent_count) << "tick " << i;
  }
  EXPECT_EQ(static_cast<hal::ControllerState>(target.back().state), hal::ControllerState::kArmed);
  const double tolerance = is_float ? 1e-4 : 1e-9;
  const Differences off = differences(host, target);
  EXPECT_LE(off.error_norm, tolerance);
  EXPECT_LE(off.threshold, tolerance);
  EXPECT_LE(off.psi_hat, tolerance);
  // A frame holds a float.
  EXPECT_LE(off.torque, std::fmax(tolerance, 1.2e-7));

  // Without a fault nothing is detected, otherwise when the run without a bus detects it.
  desk::paper::Experiment experiment;
  experiment.fault.kind = fault;
  const auto paper = run_experiment(desk::paper::two_link_robot(), experiment);
  const std::uint32_t detected = target.back().detection_tick;
  ASSERT_EQ(paper.detection_time_s.has_value(), fault != sim::FaultKind::kNone);
  if (!paper.detection_time_s) {
    EXPECT_EQ(detected, 0U);
  } else {
    EXPECT_GT(detected, 10'000U);
    EXPECT_NEAR(0.001 * detected, *paper.detection_time_s, 0.1);
    const auto size = [](const ReplayResult& r) { return std::hypot(r.psi_hat[0], r.psi_hat[1]); };
    EXPECT_GT(size(target.back()), 1.0) << "rad/s^2 of fault estimate";
  }
}

INSTANTIATE_TEST_SUITE_P(Runs, Firmware,
                         testing::Values(Case{kCortexM7, "float", sim::FaultKind::kNone},
                                         Case{kCortexM7, "float", sim::FaultKind::kMassLoss},
                                         Case{kCortexM7, "float", sim::FaultKind::kNonlinear},
                                         Case{kCortexM7, "double", sim::FaultKind::kNone},
                                         Case{kCortexM7, "double", sim::FaultKind::kMassLoss},
                                         Case{kCortexM7, "double", sim::FaultKind::kNonlinear},
                                         Case{kCortexM4, "float", sim::FaultKind::kMassLoss}),
                         [](const auto& run) {
                           std::string name = std::string(run.param.board.preset) + "_" +
                                              run.param.scalar + "_" +
                                              desk::paper::name_of(run.param.fault);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(FirmwareImage, TicksInItsInterruptAndWaitsForABus) {
  EXPECT_EQ(run_on(kCortexM7, "offnominal_firmware", {}), 0);
  EXPECT_EQ(run_on(kCortexM4, "offnominal_firmware", {}), 0);
}

TEST(FirmwareImage, SaysThatAFileIsCutShort) {
  const TemporaryFolder folder;
  put(folder / "in", "not a tick");
  constexpr int kCutShort = 6;
  EXPECT_EQ(run_on(kCortexM7, "offnominal_replay_float",
                   {"10", (folder / "in").string(), (folder / "out").string()}),
            kCutShort);
}

}  // namespace
}  // namespace offnominal::test
