#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <offnominal/hal/bus/bus.hpp>
#include <offnominal/hal/protocols/protected/protected_drives.hpp>
#include <span>
#include <vector>

#include "wcet/tick.hpp"

// The two ends of a measured tick: a bus whose frames lie ready, and drives that note when they are
// called. The marks between the phases are the calls that the controller makes there anyway.

namespace offnominal::desk::wcet {

[[nodiscard]] inline std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// Times at the beginning of a tick and at the end of each phase; none are taken while it is off.
class PhaseMarks {
 public:
  void start() {
    on_ = true;
    at_[0] = now_ns();
  }
  /// The first call counts.
  void end_of(Phase phase) {
    if (!on_) return;
    const std::size_t index = static_cast<std::size_t>(phase) + 1;
    if (at_[index] == 0) at_[index] = now_ns();
  }
  /// Durations; a phase that was not reached has none.
  void stop(std::array<std::int64_t, kPhases>& duration_ns) {
    end_of(Phase::kSend);
    std::int64_t before = at_[0];
    for (std::size_t i = 0; i < kPhases; ++i) {
      duration_ns[i] = at_[i + 1] == 0 ? 0 : at_[i + 1] - before;
      if (at_[i + 1] != 0) before = at_[i + 1];
    }
    at_ = {};
    on_ = false;
  }

 private:
  bool on_ = false;
  std::array<std::int64_t, kPhases + 1> at_{};
};

/// A bus: receive() hands out prepared frames, send() takes everything.
class ReadyBus {
 public:
  void set_frames(std::vector<hal::ReceivedFrame> frames) {
    frames_ = std::move(frames);
    next_ = 0;
  }
  void rewind() { next_ = 0; }
  [[nodiscard]] std::size_t handed_out() const { return next_; }

  // When its frames came: all of a tick at once.
  [[nodiscard]] hal::Microseconds now() const {
    return frames_.empty() ? 0 : frames_.front().time_us;
  }
  [[nodiscard]] hal::Status send(const hal::Frame& frame, hal::Microseconds /*deadline_us*/) {
    sent_ = frame;
    return hal::Status::kOk;
  }
  [[nodiscard]] std::size_t receive(std::span<hal::ReceivedFrame> into) {
    std::size_t count = 0;
    while (count < into.size() && next_ < frames_.size()) into[count++] = frames_[next_++];
    return count;
  }
  void drop_pending() {}
  [[nodiscard]] hal::BusState state() const { return {}; }

 private:
  std::vector<hal::ReceivedFrame> frames_;
  std::size_t next_ = 0;
  hal::Frame sent_;
};

template <std::size_t Joints>
class MarkedDrives {
 public:
  static constexpr std::size_t kJoints = Joints;
  static constexpr std::size_t kMaxOutgoing = hal::ProtectedDrives<Joints>::kMaxOutgoing;

  MarkedDrives(const hal::SourceConfig& source, hal::FrameFormat format, PhaseMarks& marks)
      : drives_(source, source, format), marks_(&marks) {}

  [[nodiscard]] hal::Status take(const hal::ReceivedFrame& received) {
    return drives_.take(received);
  }
  [[nodiscard]] hal::JointFeedback feedback(std::size_t joint, hal::Microseconds now_us) const {
    marks_->end_of(Phase::kReceive);
    return drives_.feedback(joint, now_us);
  }
  [[nodiscard]] std::size_t outgoing(std::span<const hal::TorqueCommand> commands,
                                     const hal::Heartbeat& heartbeat, std::span<hal::Frame> into) {
    marks_->end_of(Phase::kControl);
    return drives_.outgoing(commands, heartbeat, into);
  }
  [[nodiscard]] bool report(const hal::Diagnosis& found, hal::Frame& into) {
    return drives_.report(found, into);
  }
  [[nodiscard]] bool report(const hal::FaultReport& fault, hal::Frame& into) {
    return drives_.report(fault, into);
  }
  [[nodiscard]] hal::Microseconds drive_max_age_us() const { return drives_.drive_max_age_us(); }
  [[nodiscard]] bool stop_seen() const { return drives_.stop_seen(); }
  void clear_stop() { drives_.clear_stop(); }
  [[nodiscard]] hal::DriveCounts counts() const { return drives_.counts(); }

 private:
  hal::ProtectedDrives<Joints> drives_;
  PhaseMarks* marks_;
};

}  // namespace offnominal::desk::wcet
