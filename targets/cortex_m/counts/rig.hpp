// The controller of robot_model.hpp with all that a tick reads and writes, as plain data that can
// be put back: what the counts are taken of.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <offnominal/controller/joint_controller.hpp>
#include <offnominal/hal/protocols/protected/protected_drives.hpp>
#include <robot_model.hpp>
#include <span>

namespace offnominal::cortex_m {

using Scalar = OFFNOMINAL_SCALAR;
inline constexpr int kJoints = robot_model::kJoints;
inline constexpr auto kCount = static_cast<std::size_t>(kJoints);
inline constexpr hal::Microseconds kPeriodUs = 1000;

using Controller =
    controller::JointController<kJoints, robot_model::kHiddenUnits, Scalar, robot_model::Memory,
                                robot_model::Space, robot_model::Isolates>;
using Drives = hal::ProtectedDrives<kCount>;

// Frames of one tick in, those of its end out: nothing but copies, as from a FIFO in memory.
class FrameBus {
 public:
  void begin(hal::Microseconds now_us) {
    now_us_ = now_us;
    next_ = count_ = sent_ = 0;
  }
  void put(const hal::Frame& frame) { in_[count_++] = {frame, now_us_}; }

  [[nodiscard]] hal::Microseconds now() const { return now_us_; }
  [[nodiscard]] hal::Status send(const hal::Frame& frame, hal::Microseconds /*deadline_us*/) {
    out_[sent_++] = frame;
    return hal::Status::kOk;
  }
  [[nodiscard]] std::size_t receive(std::span<hal::ReceivedFrame> into) {
    std::size_t taken = 0;
    while (taken < into.size() && next_ < count_) into[taken++] = in_[next_++];
    return taken;
  }
  void drop_pending() {}
  [[nodiscard]] hal::BusState state() const { return {}; }

 private:
  hal::Microseconds now_us_ = 0;
  std::size_t next_ = 0, count_ = 0, sent_ = 0;
  std::array<hal::ReceivedFrame, 2 * kCount> in_{};
  std::array<hal::Frame, kCount + 3> out_{};  // heartbeat, diagnosis and fault too
};
static_assert(hal::Bus<FrameBus>);

// What a tick changes.
struct Memory {
  FrameBus bus;
  Drives drives{hal::SourceConfig{}, hal::SourceConfig{}, hal::FrameFormat::kClassic};
  Controller::Data data;
};

}  // namespace offnominal::cortex_m

extern "C" {
// The whole tick: receive, decode, judge, estimate, detect, accommodate, command, encode, send.
void offnominal_tick(const offnominal::cortex_m::Controller& controller,
                     const offnominal::Reference<offnominal::cortex_m::kJoints,
                                                 offnominal::cortex_m::Scalar>& reference,
                     offnominal::cortex_m::Memory& memory);
// The monitor alone: dynamics, estimate, detect, accommodate.
offnominal::Status offnominal_monitor(
    const offnominal::cortex_m::Controller& controller,
    const offnominal::JointSample<offnominal::cortex_m::kJoints, offnominal::cortex_m::Scalar>&
        sample,
    offnominal::cortex_m::Memory& memory);
}
