#include "live/bus_samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "loop/controller_settings.hpp"

namespace offnominal::desk::live {
namespace {

using hal::Microseconds;
using hal::SourceState;

// Of the same robot in either space: what a sample is does not depend on it.
controller::SampleTaker<kRuntimeJoints, double> taker_of(const RobotDescription& robot) {
  if (robot.estimator.space == EstimatorSpace::kTorque) {
    return controller::SampleTaker<kRuntimeJoints, double>(
        controller_config_of<kRuntimeJoints, double, TorqueSpace>(robot, {}));
  }
  return controller::SampleTaker<kRuntimeJoints, double>(
      controller_config_of<kRuntimeJoints, double, AccelerationSpace>(robot, {}));
}

}  // namespace

BusSamples::BusSamples(const RobotDescription& robot)
    : joints_(robot.joints.size()),
      period_us_(period_us_of(robot.estimator.period_s)),
      protocol_(protocol_of(robot.drive_settings())),
      readings_(robot.drive_settings(), joints_, {period_us_, hal::FrameFormat::kClassic}),
      taker_(taker_of(robot)) {
  size_for(joints_, data_.implausible_time_us, data_.used_time_us, data_.motion, data_.turns);
  size_for(joints_, data_.sample.q, data_.sample.dq, data_.sample.tau);
  size_for(joints_, data_.observed.q, data_.observed.dq, data_.observed.tau);
  size_for(joints_, sample_.sample.joints.q, sample_.sample.joints.dq, sample_.sample.joints.tau);
}

const BusSample* BusSamples::take(const hal::ReceivedFrame& received) {
  ++frames_;
  // A controller says how it is; its words are no drive's.
  hal::Heartbeat heartbeat;
  const bool is_heartbeat = protocol_.heartbeat_in(received.frame, heartbeat);
  if (is_heartbeat) heartbeat_ = heartbeat;
  const Taker::Feedback* const readings = readings_.take(received);
  if (is_heartbeat || readings_.understood()) ++understood_;
  return readings != nullptr && hand_over(*readings) ? &sample_ : nullptr;
}

// False where they cannot be used: a position that cannot be, or a velocity that is not
// settled yet.
bool BusSamples::hand_over(const Taker::Feedback& readings) {
  Microseconds time_us = readings[0].encoder_time_us;
  for (std::size_t j = 1; j < joints_; ++j) {
    time_us = std::max(time_us, readings[j].encoder_time_us);
  }
  std::uint32_t missing = 0;
  if (last_us_) {
    const double ticks = static_cast<double>(time_us - *last_us_) / static_cast<double>(period_us_);
    constexpr double kMost = 1e9;
    missing = static_cast<std::uint32_t>(std::max(0.0, std::min(kMost, std::round(ticks) - 1)));
  }
  data_.unseen_ticks = missing;
  taker_.screen(readings, data_);
  taker_.take(readings, data_);
  if (!data_.fresh) return false;
  data_.unseen_ticks = 0;
  last_us_ = time_us;
  if (!taker_.is_settled(data_)) return false;
  sample_.sample = {data_.judged(), data_.sample.q};
  sample_.time_us = time_us;
  sample_.missing = missing;
  sample_.driven = std::all_of(readings.begin(), readings.end(), [](const auto& joint) {
    return joint.drive == SourceState::kValid && joint.status.mode == hal::DriveMode::kTorque;
  });
  return true;
}

std::vector<std::size_t> BusSamples::silent_joints(Microseconds now_us) const {
  std::vector<std::size_t> silent;
  for (std::size_t j = 0; j < joints_; ++j) {
    if (readings_.feedback(j, now_us).encoder != SourceState::kValid) silent.push_back(j);
  }
  return silent;
}

}  // namespace offnominal::desk::live
