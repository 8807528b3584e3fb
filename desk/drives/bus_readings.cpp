#include "drives/bus_readings.hpp"

#include <algorithm>
#include <offnominal/hal/source.hpp>
#include <offnominal/hal/status.hpp>

namespace offnominal::desk {

BusReadings::BusReadings(const DriveSettings& settings, std::size_t joints,
                         const hal::DriveLink& link)
    : joints_(joints), drives_(make_drive_port(settings, joints, link)) {
  used_us_.assign(joints_, 0);
  for (Feedback* const all : {&now_, &complete_, &handed_}) all->assign(joints_, {});
}

const BusReadings::Feedback* BusReadings::take(const hal::ReceivedFrame& received) {
  hal::Status status = drives_->take(received);
  if (status == hal::Status::kUnknownId) status = drives_->overhear(received);
  understood_ = status == hal::Status::kOk;
  if (!understood_) return nullptr;
  for (std::size_t j = 0; j < joints_; ++j) now_[j] = drives_->feedback(j, received.time_us);
  const bool is_handed = waits_ && is_next();
  if (is_handed) {
    handed_ = complete_;
    for (std::size_t j = 0; j < joints_; ++j) used_us_[j] = handed_[j].encoder_time_us;
  }
  waits_ = is_complete();
  if (waits_) complete_ = now_;
  return is_handed ? &handed_ : nullptr;
}

bool BusReadings::is_complete() const {
  for (std::size_t j = 0; j < joints_; ++j) {
    const bool is_new = now_[j].encoder_time_us != used_us_[j];
    if (now_[j].encoder != hal::SourceState::kValid || !is_new) return false;
  }
  return true;
}

bool BusReadings::is_next() const {
  for (std::size_t j = 0; j < joints_; ++j) {
    if (now_[j].encoder_time_us != complete_[j].encoder_time_us) return true;
  }
  return false;
}

}  // namespace offnominal::desk
