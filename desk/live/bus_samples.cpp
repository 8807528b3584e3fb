#include "live/bus_samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <offnominal/hal/protocols/protected/address.hpp>
#include <string_view>

#include "drives/drive_table.hpp"
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
      has_heartbeats_(std::string_view(protocol_of(robot.drive_settings()).name) ==
                      std::string_view(drive_protocols().front().name)),
      drives_(make_drive_port(robot.drive_settings(), joints_,
                              {period_us_, hal::FrameFormat::kClassic})),
      taker_(taker_of(robot)) {
  size_for(joints_, data_.implausible_time_us, data_.used_time_us, data_.velocity, data_.turns,
           feedback_, complete_);
  size_for(joints_, data_.sample.q, data_.sample.dq, data_.sample.tau);
  size_for(joints_, sample_.sample.q, sample_.sample.dq, sample_.sample.tau);
}

const BusSample* BusSamples::take(const hal::ReceivedFrame& received) {
  ++frames_;
  heed(received.frame);
  if (drives_->take(received) != hal::Status::kOk) return nullptr;
  ++understood_;
  look(received.time_us);
  const bool handed = waits_ && is_next(complete_) && hand_over();
  const bool is_complete = [&] {
    for (std::size_t j = 0; j < joints_; ++j) {
      const bool is_new = feedback_[j].encoder_time_us != data_.used_time_us[j];
      if (feedback_[j].encoder != SourceState::kValid || !is_new) return false;
    }
    return true;
  }();
  if (is_complete) complete_ = feedback_;
  waits_ = is_complete;
  return handed ? &sample_ : nullptr;
}

// A controller of offnominal's own protocol says how it is; its words are no drive's.
void BusSamples::heed(const hal::Frame& frame) {
  hal::Address address;
  if (!has_heartbeats_ || hal::address_of(frame, address) != hal::Status::kOk) return;
  if (address.kind != hal::MessageKind::kHeartbeat) return;
  hal::Heartbeat heartbeat;
  std::uint8_t counter = 0;
  const std::uint16_t id = hal::data_id_of(address.kind, address.first_node);
  if (hal::decode(hal::record_in(frame, 0), id, heartbeat, counter) != hal::Status::kOk) return;
  heartbeat_ = heartbeat;
  ++understood_;
}

void BusSamples::look(Microseconds now_us) {
  for (std::size_t j = 0; j < joints_; ++j) feedback_[j] = drives_->feedback(j, now_us);
}

bool BusSamples::is_next(const Taker::Feedback& before) const {
  for (std::size_t j = 0; j < joints_; ++j) {
    if (feedback_[j].encoder_time_us != before[j].encoder_time_us) return true;
  }
  return false;
}

// False where what waits cannot be used: a position that cannot be, or a velocity that is not
// settled yet.
bool BusSamples::hand_over() {
  waits_ = false;
  Microseconds time_us = complete_[0].encoder_time_us;
  for (std::size_t j = 1; j < joints_; ++j) {
    time_us = std::max(time_us, complete_[j].encoder_time_us);
  }
  std::uint32_t missing = 0;
  if (last_us_) {
    const double ticks = static_cast<double>(time_us - *last_us_) / static_cast<double>(period_us_);
    constexpr double kMost = 1e9;
    missing = static_cast<std::uint32_t>(std::max(0.0, std::min(kMost, std::round(ticks) - 1)));
  }
  data_.unseen_ticks = missing;
  taker_.screen(complete_, data_);
  taker_.take(complete_, data_);
  if (!data_.fresh) return false;
  data_.unseen_ticks = 0;
  last_us_ = time_us;
  if (!taker_.is_settled(data_)) return false;
  sample_.sample = data_.sample;
  sample_.time_us = time_us;
  sample_.missing = missing;
  sample_.driven = std::all_of(complete_.begin(), complete_.end(), [](const auto& joint) {
    return joint.drive == SourceState::kValid && joint.status.mode == hal::DriveMode::kTorque;
  });
  return true;
}

std::vector<std::size_t> BusSamples::silent_joints(Microseconds now_us) const {
  std::vector<std::size_t> silent;
  for (std::size_t j = 0; j < joints_; ++j) {
    if (drives_->feedback(j, now_us).encoder != SourceState::kValid) silent.push_back(j);
  }
  return silent;
}

}  // namespace offnominal::desk::live
