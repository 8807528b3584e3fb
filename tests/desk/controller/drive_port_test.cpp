// Every row of the list of drive protocols: its driver and its emulation understand each other, and
// are what its description says.
#include "drives/drive_port.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <offnominal/hal/bus/in_process_bus.hpp>
#include <offnominal/hal/bus/wire_time.hpp>
#include <string>
#include <vector>

#include "desk/sil/serial_robot.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {
namespace {

constexpr std::size_t kJoints = 3;
constexpr int kPeriodMs = 2;

// What a file may say, by protocol. A new row has to have its line here.
const std::map<std::string, std::string> kFiles{
    {"protected", test::serial_robot_text(kJoints) + "[drives]\nprotocol = \"protected\"\n"},
    {"can_simple", test::odrive_robot_text(kJoints, kPeriodMs, "0.6")}};

bool passes_one_of(const std::vector<hal::IdFilter>& filters, const hal::Frame& frame) {
  return std::any_of(filters.begin(), filters.end(),
                     [&](const hal::IdFilter& filter) { return passes(filter, frame); });
}

// Both ends of a bus, tick by tick; the joints stand at 0.1 rad, 0.2 rad, ...
class BothEnds {
 public:
  BothEnds(const DriveSettings& settings, hal::FrameFormat format)
      : settings_(settings), link_{.period_us = 1000 * kPeriodMs, .format = format} {}

  void tick(hal::DriveMode mode) {
    now_us_ += link_.period_us;
    net_.set_time(now_us_);
    std::array<hal::ReceivedFrame, 64> come;
    for (std::size_t i = plant_port_.receive(come); i > 0; --i) {
      emulated->take(come[i - 1]);
    }
    emulated->tick(now_us_);
    std::array<sim::Drives::Reading, kJoints> readings;
    std::array<double, kJoints> applied{};
    for (std::size_t j = 0; j < kJoints; ++j) {
      readings[j] = hal::EncoderReading{0.1F * static_cast<float>(j + 1), -0.5F, true};
      applied[j] = emulated->torque_nm(j, -0.5);
    }
    std::array<hal::Frame, sim::Drives::kMostFrames> frames;
    const std::size_t made = emulated->frames(readings, applied, frames);
    carry(std::span<const hal::Frame>(frames).first(made), from_drives(settings_), plant_port_);
    for (std::size_t i = controller_port_.receive(come); i > 0; --i) {
      const hal::Status status = driver->take(come[i - 1]);
      // The first frames of a sender may have to follow one another.
      EXPECT_TRUE(status == hal::Status::kOk || ticks_ < 10) << hal::name_of(status);
    }
    std::array<hal::TorqueCommand, kJoints> commands;
    for (std::size_t j = 0; j < kJoints; ++j) {
      const bool drives = mode == hal::DriveMode::kTorque;
      commands[j] = {mode, drives ? static_cast<float>(j + 1) : 0.0F};
    }
    std::array<hal::Frame, DrivePort::kMaxOutgoing> outgoing;
    const std::size_t count =
        driver->outgoing(commands, {hal::ControllerState::kArmed, 0, ticks_++}, outgoing);
    carry(std::span<const hal::Frame>(outgoing).first(count), from_controller(settings_),
          controller_port_);
  }

  [[nodiscard]] hal::JointFeedback feedback(std::size_t joint) const {
    return driver->feedback(joint, now_us_);
  }
  [[nodiscard]] double busy_share() const {
    return busy_s_ / (1e-6 * static_cast<double>(now_us_));
  }
  [[nodiscard]] double most_busy() const {
    return protocol_of(settings_).busy_share(values_of(settings_), kJoints, link_.format,
                                             1e-3 * kPeriodMs);
  }

 private:
  using Net = hal::InProcessNet<2>;

  void carry(std::span<const hal::Frame> frames, const std::vector<hal::IdFilter>& filters,
             Net::Port& port) {
    for (const hal::Frame& frame : frames) {
      EXPECT_TRUE(passes_one_of(filters, frame)) << std::hex << frame.id;
      EXPECT_EQ(port.send(frame, now_us_), hal::Status::kOk);
      busy_s_ += hal::longest_wire_time_s(frame);
    }
  }

  DriveSettings settings_;
  hal::DriveLink link_;
  Net net_;
  Net::Port controller_port_ = net_.port(0);
  Net::Port plant_port_ = net_.port(1);
  hal::Microseconds now_us_ = 0;
  std::uint32_t ticks_ = 0;
  double busy_s_ = 0;

 public:
  std::unique_ptr<sim::Drives> emulated = emulated_drives(settings_, {kJoints, link_});
  std::unique_ptr<DrivePort> driver = make_drive_port(settings_, kJoints, link_);
};

class EveryProtocol : public testing::TestWithParam<std::size_t> {
 protected:
  static const DriveProtocol& protocol() { return drive_protocols()[GetParam()]; }
  static DriveSettings settings() {
    return parse_robot(kFiles.at(protocol().name), "file.toml").drive_settings();
  }
  static std::vector<hal::FrameFormat> formats() {
    if (!protocol().has_fd) return {hal::FrameFormat::kClassic};
    return {hal::FrameFormat::kClassic, hal::FrameFormat::kFd};
  }
};

TEST_P(EveryProtocol, HasADriverAndDrivesThatUnderstandEachOther) {
  for (const hal::FrameFormat format : formats()) {
    BothEnds ends(settings(), format);
    for (int i = 0; i < 100; ++i) ends.tick(hal::DriveMode::kOff);
    for (std::size_t j = 0; j < kJoints; ++j) {
      EXPECT_EQ(ends.feedback(j).encoder, hal::SourceState::kValid) << j;
      EXPECT_EQ(ends.feedback(j).drive, hal::SourceState::kValid) << j;
      EXPECT_NEAR(ends.feedback(j).reading.position, 0.1 * static_cast<double>(j + 1), 1e-5) << j;
      EXPECT_NEAR(ends.feedback(j).reading.velocity, -0.5, 1e-3) << j;
      EXPECT_EQ(ends.feedback(j).status.mode, hal::DriveMode::kOff) << j;
    }
    EXPECT_FALSE(ends.emulated->any_in_torque_mode());
    for (int i = 0; i < 200; ++i) ends.tick(hal::DriveMode::kTorque);
    EXPECT_TRUE(ends.emulated->all_in_torque_mode());
    for (std::size_t j = 0; j < kJoints; ++j) {
      const auto wanted = static_cast<double>(j + 1);
      EXPECT_EQ(ends.feedback(j).status.mode, hal::DriveMode::kTorque) << j;
      EXPECT_NEAR(ends.feedback(j).status.applied_torque, wanted, 1e-3) << j;
      EXPECT_NEAR(ends.emulated->torque_nm(j, 0), wanted, 1e-3) << j;
      EXPECT_GT(ends.emulated->commands(j), 200U) << j;
    }
    for (int i = 0; i < 60; ++i) ends.tick(hal::DriveMode::kOff);
    EXPECT_FALSE(ends.emulated->any_in_torque_mode());
    // Heartbeats of a controller are not in it.
    EXPECT_LT(ends.busy_share(), 1.1 * ends.most_busy());
    EXPECT_GT(ends.busy_share(), 0.5 * ends.most_busy());
    EXPECT_EQ(ends.driver->counts().rejected, 0U);
  }
}

// GIVEN nobody who commands WHEN the drives were in torque mode THEN they let go by themselves.
TEST_P(EveryProtocol, HasDrivesWithAWatchDog) {
  BothEnds ends(settings(), hal::FrameFormat::kClassic);
  for (int i = 0; i < 200; ++i) ends.tick(hal::DriveMode::kTorque);
  ASSERT_TRUE(ends.emulated->all_in_torque_mode());
  for (int i = 1; i <= 60; ++i) ends.emulated->tick((400 + kPeriodMs * i) * 1000);
  EXPECT_FALSE(ends.emulated->any_in_torque_mode());
}

TEST_P(EveryProtocol, KnowsWhoseAFrameIs) {
  const auto drives = emulated_drives(settings(), {.joints = kJoints});
  hal::Frame frame;
  frame.length = hal::kMaxClassicLength;
  for (std::size_t j = 0; j < kJoints; ++j) {
    for (const std::uint32_t id : {drives->reading_id(j), drives->command_id(j)}) {
      frame.id = id;
      for (std::size_t other = 0; other < kJoints; ++other) {
        EXPECT_EQ(drives->concerns(frame, other), other == j) << j << ' ' << other;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(List, EveryProtocol,
                         testing::Range(std::size_t{0}, drive_protocols().size()),
                         [](const auto& row) { return drive_protocols()[row.param].name; });

}  // namespace
}  // namespace offnominal::desk
