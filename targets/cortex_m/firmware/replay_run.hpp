// A run of the joint controller on recorded frames; the same code on the target and on the host.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <offnominal/controller/joint_firmware.hpp>
#include <offnominal/hal/bus/bus.hpp>
#include <span>
#include <type_traits>

namespace offnominal::cortex_m {

// What the files hold: numbers as they lie in memory, little-endian on both sides.
struct ReplayFrame {
  std::uint32_t id = 0;
  std::uint32_t length = 0;
  std::array<std::uint8_t, hal::kMaxClassicLength> data{};
};

inline constexpr std::size_t kReplayJoints = robot_model::kJoints;

// What one tick begins with.
struct ReplayTick {
  std::array<double, kReplayJoints> q{};  // reference, rad; its derivatives
  std::array<double, kReplayJoints> dq{};
  std::array<double, kReplayJoints> ddq{};
  std::uint32_t frame_count = 0;
  std::uint32_t unused = 0;
  std::array<ReplayFrame, 2 * kReplayJoints> frames{};
};

// What it ends with.
struct ReplayResult {
  std::uint32_t state = 0;
  std::uint32_t fault = 0;
  std::uint32_t detection_tick = 0;  // 0: nothing detected so far
  std::uint32_t sent_count = 0;
  double error_norm = 0;
  double threshold = 0;
  std::array<double, kReplayJoints> psi_hat{};
  std::array<double, kReplayJoints> compensation{};
  std::array<ReplayFrame, kReplayJoints + 1> sent{};
};
static_assert(std::is_trivially_copyable_v<ReplayTick> && sizeof(ReplayTick) % 8 == 0);
static_assert(std::is_trivially_copyable_v<ReplayResult> && sizeof(ReplayResult) % 8 == 0);

// Hands over the frames of the tick and takes note of those that are sent.
class ReplayBus {
 public:
  void begin(const ReplayTick& tick, hal::Microseconds now_us) {
    tick_ = &tick;
    now_us_ = now_us;
    next_ = 0;
    sent_count_ = 0;
  }
  [[nodiscard]] std::span<const ReplayFrame> sent() const {
    return std::span(sent_).first(sent_count_);
  }

  [[nodiscard]] hal::Microseconds now() const { return now_us_; }
  [[nodiscard]] hal::Status send(const hal::Frame& frame, hal::Microseconds deadline_us) {
    if (deadline_us < now_us_) return hal::Status::kDeadlinePassed;
    if (sent_count_ == sent_.size()) return hal::Status::kQueueFull;
    ReplayFrame& into = sent_[sent_count_++];
    into.id = frame.id;
    into.length = frame.length;
    std::copy_n(frame.data.begin(), into.data.size(), into.data.begin());
    return hal::Status::kOk;
  }
  [[nodiscard]] std::size_t receive(std::span<hal::ReceivedFrame> into) {
    std::size_t count = 0;
    while (count < into.size() && next_ < tick_->frame_count) {
      const ReplayFrame& from = tick_->frames[next_++];
      hal::ReceivedFrame& received = into[count++];
      received = {};
      received.frame.id = from.id;
      received.frame.length = static_cast<std::uint8_t>(from.length);
      std::copy(from.data.begin(), from.data.end(), received.frame.data.begin());
      received.time_us = now_us_;
    }
    return count;
  }
  void drop_pending() {}
  [[nodiscard]] hal::BusState state() const { return {}; }

 private:
  const ReplayTick* tick_ = nullptr;
  hal::Microseconds now_us_ = 0;
  std::size_t next_ = 0;
  std::size_t sent_count_ = 0;
  std::array<ReplayFrame, kReplayJoints + 1> sent_{};
};
static_assert(hal::Bus<ReplayBus>);

// Tick after tick from cold; it arms as soon as every joint has been heard.
template <typename Scalar>
class ReplayRun {
 public:
  [[nodiscard]] Status start() { return firmware_.start(); }

  void tick(const ReplayTick& tick, ReplayResult& result) {
    now_us_ += Firmware::kPeriodUs;
    bus_.begin(tick, now_us_);
    const auto reference_at = [&tick](double /*time_s*/) {
      Reference<Firmware::kJoints, Scalar> reference;
      for (std::size_t j = 0; j < kReplayJoints; ++j) {
        const auto i = static_cast<Eigen::Index>(j);
        reference.q[i] = static_cast<Scalar>(tick.q[j]);
        reference.dq[i] = static_cast<Scalar>(tick.dq[j]);
        reference.ddq[i] = static_cast<Scalar>(tick.ddq[j]);
      }
      return reference;
    };
    firmware_.tick(now_us_, 0, reference_at);
    tell(result);
    static_cast<void>(firmware_.arm(reference_at));  // refused but in kPassive
  }

 private:
  using Firmware = controller::JointFirmware<ReplayBus, Scalar>;

  void tell(ReplayResult& result) const {
    const auto& data = firmware_.data();
    result = {};
    result.state = static_cast<std::uint32_t>(data.state);
    result.fault = static_cast<std::uint32_t>(data.fault);
    result.detection_tick = static_cast<std::uint32_t>(data.output.detector.detection_tick);
    result.sent_count = static_cast<std::uint32_t>(bus_.sent().size());
    std::copy(bus_.sent().begin(), bus_.sent().end(), result.sent.begin());
    result.error_norm = static_cast<double>(data.output.error_norm);
    result.threshold = static_cast<double>(data.output.threshold);
    for (std::size_t j = 0; j < kReplayJoints; ++j) {
      const auto i = static_cast<Eigen::Index>(j);
      result.psi_hat[j] = static_cast<double>(data.output.psi_hat[i]);
      result.compensation[j] = static_cast<double>(data.output.compensation.torque[i]);
    }
  }

  ReplayBus bus_;
  Firmware firmware_{bus_};
  hal::Microseconds now_us_ = 0;
};

}  // namespace offnominal::cortex_m
