// A bus with faults in it: stands between one end and the real thing.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <offnominal/hal/bus/bus.hpp>
#include <random>
#include <span>
#include <vector>

#include "offnominal/sim/bus/drives.hpp"
#include "offnominal/sim/bus/fault_event.hpp"

namespace offnominal::sim {

enum class BusEnd : std::uint8_t { kController, kPlant };

/// A Bus that passes on to another what the faults of its schedule leave of it. blocked_bus and
/// bus_off act at the controller's end, all others at the plant's. Seeded: the same frames at the
/// same times meet the same faults.
template <hal::Bus Inner>
class FaultyBus {
 public:
  /// drives: of the plant, which have to outlive it; forged frames are of one of them.
  FaultyBus(Inner& inner, BusEnd end, const Drives& drives, const std::vector<FaultEvent>& events,
            std::uint64_t seed)
      : inner_(inner),
        end_(end),
        drives_(drives),
        random_(seed),
        node_(0, static_cast<int>(drives.joints()) - 1) {
    set_events(events);
  }

  /// From now on the faults of this end among these, and no others.
  void set_events(const std::vector<FaultEvent>& events) {
    events_.clear();
    for (const FaultEvent& event : events) {
      const bool controllers =
          event.kind == FaultEventKind::kBlockedBus || event.kind == FaultEventKind::kBusOff;
      const bool mine = info_of(event.kind).on_bus && controllers == (end_ == BusEnd::kController);
      if (mine) events_.push_back(event);
    }
  }

  /// Time of the schedule, s; to be set every tick, before the bus is used.
  void set_time(double time_s) {
    time_s_ = time_s;
    if (!is_on(FaultEventKind::kBlockedBus)) let_go();
    release_due();
    if (const FaultEvent* babble = active(FaultEventKind::kBabblingNode)) {
      hal::Frame frame;
      frame.id = 0x001;
      frame.length = hal::kMaxClassicLength;
      send_many(*babble, [&] { return frame; });
    }
    if (const FaultEvent* replay = active(FaultEventKind::kReplayedBurst)) {
      std::size_t next = 0;
      if (!history_.empty()) {
        send_many(*replay, [&] { return history_[next++ % history_.size()]; });
      }
    }
    if (const FaultEvent* forge = active(FaultEventKind::kForgedFrames)) {
      send_many(*forge, [&] { return forged(&Drives::reading_id); });
      for (int i = 0; i < count_of(*forge); ++i) {
        forged_in_.push_back({forged(&Drives::command_id), inner_.now()});
      }
    }
  }

  [[nodiscard]] hal::Microseconds now() { return inner_.now(); }

  [[nodiscard]] hal::Status send(const hal::Frame& frame, hal::Microseconds deadline_us) {
    if (is_on(FaultEventKind::kBusOff)) return hal::Status::kBusOff;
    if (is_on(FaultEventKind::kBlockedBus)) return hold(frame, deadline_us);
    if (is_silent(frame) || happens(FaultEventKind::kFrameLoss)) return hal::Status::kOk;
    remember(frame);
    hal::Frame changed = frame;
    if (happens(FaultEventKind::kCorruptedFrames)) corrupt(changed);
    if (const FaultEvent* delay = active(FaultEventKind::kDelayedFrames)) {
      delayed_.push_back({changed, time_s_ + delay->size});
      return hal::Status::kOk;
    }
    if (!swapped_.empty()) {
      const hal::Status status = inner_.send(changed, deadline_us);
      const hal::Frame late = swapped_.front();
      swapped_.clear();
      static_cast<void>(inner_.send(late, deadline_us));
      return status;
    }
    if (happens(FaultEventKind::kReorderedFrames)) {
      swapped_.push_back(changed);
      return hal::Status::kOk;
    }
    if (happens(FaultEventKind::kDuplicateFrames)) {
      static_cast<void>(inner_.send(changed, deadline_us));
    }
    return inner_.send(changed, deadline_us);
  }

  [[nodiscard]] std::size_t receive(std::span<hal::ReceivedFrame> into) {
    drop_late();
    std::size_t count = 0;
    while (!forged_in_.empty() && count < into.size()) {
      into[count++] = forged_in_.front();
      forged_in_.pop_front();
    }
    const bool deaf = is_on(FaultEventKind::kBlockedBus) || is_on(FaultEventKind::kBusOff);
    while (count < into.size()) {
      const auto come = into.subspan(count);
      const std::size_t fetched = inner_.receive(come);
      if (fetched == 0) break;
      const auto end = std::remove_if(
          come.begin(), come.begin() + static_cast<std::ptrdiff_t>(fetched),
          [&](const hal::ReceivedFrame& frame) { return deaf || is_silent(frame.frame); });
      count += static_cast<std::size_t>(end - come.begin());
    }
    return count;
  }

  void drop_pending() {
    held_.clear();
    inner_.drop_pending();
  }

  [[nodiscard]] hal::BusState state() const {
    hal::BusState state = inner_.state();
    if (is_on(FaultEventKind::kBusOff)) state.mode = hal::BusMode::kOff;
    state.late += late_;
    return state;
  }

 private:
  struct Held {
    hal::Frame frame;
    hal::Microseconds deadline_us;
  };
  struct Delayed {
    hal::Frame frame;
    double due_s;
  };

  [[nodiscard]] const FaultEvent* active(FaultEventKind kind) const {
    for (const FaultEvent& event : events_) {
      if (event.kind == kind && event.is_active(time_s_)) return &event;
    }
    return nullptr;
  }
  [[nodiscard]] bool is_on(FaultEventKind kind) const { return active(kind) != nullptr; }
  // Draws only while the fault is there: other faults do not shift its luck.
  bool happens(FaultEventKind kind) {
    const FaultEvent* event = active(kind);
    return event != nullptr && std::uniform_real_distribution<double>()(random_) < event->size;
  }
  static int count_of(const FaultEvent& event) { return static_cast<int>(event.size); }

  template <typename Make>
  void send_many(const FaultEvent& event, Make&& make) {
    for (int i = 0; i < count_of(event); ++i) {
      static_cast<void>(inner_.send(make(), inner_.now() + 1000));
    }
  }

  [[nodiscard]] bool is_silent(const hal::Frame& frame) const {
    const FaultEvent* silent = active(FaultEventKind::kSilentNode);
    return silent != nullptr && silent->joint >= 0 &&
           drives_.concerns(frame, static_cast<std::size_t>(silent->joint));
  }

  void remember(const hal::Frame& frame) {
    constexpr std::size_t kRemembered = 256;
    history_.push_back(frame);
    // Old enough that no counter is next in turn.
    if (history_.size() > kRemembered) history_.pop_front();
  }

  void corrupt(hal::Frame& frame) {
    const int flips = std::uniform_int_distribution<int>(1, 5)(random_);
    std::uniform_int_distribution<int> bit(0, 8 * frame.length - 1);
    for (int i = 0; i < flips; ++i) {
      const int at = bit(random_);
      auto& byte = frame.data[static_cast<std::size_t>(at / 8)];
      byte = static_cast<std::uint8_t>(byte ^ (1 << (at % 8)));
    }
  }

  hal::Frame forged(std::uint32_t (Drives::*id_of)(std::size_t) const) {
    hal::Frame frame;
    frame.length = hal::kMaxClassicLength;
    std::uniform_int_distribution<int> byte(0, 255);
    for (std::size_t i = 0; i < hal::kMaxClassicLength; ++i) {
      frame.data[i] = static_cast<std::uint8_t>(byte(random_));
    }
    frame.id = (drives_.*id_of)(static_cast<std::size_t>(node_(random_)));
    return frame;
  }

  hal::Status hold(const hal::Frame& frame, hal::Microseconds deadline_us) {
    const auto same = [&](const Held& held) { return held.frame.id == frame.id; };
    std::erase_if(held_, same);
    held_.push_back({frame, deadline_us});
    return hal::Status::kOk;
  }
  void drop_late() {
    const hal::Microseconds now_us = inner_.now();
    late_ += static_cast<std::uint32_t>(
        std::erase_if(held_, [&](const Held& held) { return held.deadline_us < now_us; }));
  }
  void let_go() {
    drop_late();
    for (const Held& held : held_) static_cast<void>(inner_.send(held.frame, held.deadline_us));
    held_.clear();
  }
  void release_due() {
    while (!delayed_.empty() && delayed_.front().due_s <= time_s_) {
      static_cast<void>(inner_.send(delayed_.front().frame, inner_.now() + 1000));
      delayed_.pop_front();
    }
  }

  Inner& inner_;
  BusEnd end_;
  const Drives& drives_;
  std::mt19937_64 random_;
  std::uniform_int_distribution<int> node_;
  std::vector<FaultEvent> events_;
  double time_s_ = 0.0;
  std::vector<Held> held_;
  std::deque<Delayed> delayed_;
  std::deque<hal::Frame> history_;
  std::deque<hal::ReceivedFrame> forged_in_;
  std::vector<hal::Frame> swapped_;
  std::uint32_t late_ = 0;
};

}  // namespace offnominal::sim
