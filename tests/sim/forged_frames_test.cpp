// A million frames that do not come from who they say they come from, among those that do.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <deque>
#include <iostream>
#include <map>
#include <offnominal/hal/protocols/protected/protected_drives.hpp>
#include <random>
#include <utility>
#include <vector>

#include "hal/bitwise_crc.hpp"
#include "offnominal/sim/bus/joint_drives.hpp"
#include "support/repetitions.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

using hal::Frame;
using hal::MessageKind;

constexpr std::size_t kArms = 2;
constexpr hal::Microseconds kTickUs = 1000;

// Both ends of a bus that carries a healthy run, and everything that was ever on it.
class HealthyBus {
 public:
  void tick() {
    now_us_ += kTickUs;
    std::array<Frame, 8> frames;
    const std::array<std::optional<hal::EncoderReading>, kArms> readings = {
        hal::EncoderReading{0.1F, 0.2F, true}, hal::EncoderReading{-0.3F, 0.4F, true}};
    std::size_t count = drives_.frames(readings, std::array{1.0, 2.0}, frames);
    for (std::size_t i = 0; i < count; ++i) carry(frames[i]);
    const std::array<hal::TorqueCommand, kArms> commands = {
        {{hal::DriveMode::kTorque, 1.0F}, {hal::DriveMode::kTorque, 2.0F}}};
    // Without the heartbeat, which nobody here listens to.
    count = controller_.outgoing(commands, {hal::ControllerState::kArmed, 0, 1}, frames);
    for (std::size_t i = 0; i < count; ++i) carry(frames[i]);
  }
  // To both ends, as on a bus.
  void inject(const Frame& frame) {
    static_cast<void>(controller_.take({frame, now_us_}));
    static_cast<void>(drives_.take({frame, now_us_}));
  }
  [[nodiscard]] std::uint64_t accepted() const {
    std::uint64_t sum = 0;
    for (std::size_t j = 0; j < kArms; ++j) {
      sum += std::uint64_t{controller_.encoder_source(j).accepted} +
             controller_.drive_source(j).accepted + drives_.source(j).accepted;
    }
    return sum;
  }
  [[nodiscard]] bool all_valid() const {
    for (std::size_t j = 0; j < kArms; ++j) {
      const hal::JointFeedback joint = controller_.feedback(j, now_us_);
      const bool heard =
          hal::state_of(kCommands, drives_.source(j), now_us_) == hal::SourceState::kValid;
      if (joint.encoder != hal::SourceState::kValid || joint.drive != hal::SourceState::kValid ||
          !heard) {
        return false;
      }
    }
    return true;
  }
  // Whether it is what the true sender could send next, by another implementation of the CRC.
  [[nodiscard]] bool could_be_next(const Frame& frame) const {
    hal::Address address;
    if (address_of(frame, address) != hal::Status::kOk) return false;
    const auto last = last_counter_.find(frame.id);
    const std::uint16_t crc =
        bitwise_crc(std::span(frame.data).first<6>(), data_id_of(address.kind, address.first_node));
    const bool right_crc = frame.data[6] == crc >> 8U && frame.data[7] == (crc & 0xFFU);
    if (last == last_counter_.end() || !right_crc) return false;
    const auto step = static_cast<std::uint8_t>(frame.data[hal::kCounterByte] - last->second);
    return step >= 1 && step <= kSource.max_counter_step;
  }
  [[nodiscard]] const std::deque<Frame>& history() const { return history_; }

 private:
  static constexpr hal::SourceConfig kSource{.max_age_us = 2500};
  static constexpr hal::SourceConfig kCommands{.max_age_us = 5000, .sequence_needed = 1};

  void carry(const Frame& frame) {
    inject(frame);
    last_counter_[frame.id] = frame.data[hal::kCounterByte];
    history_.push_back(frame);
    constexpr std::size_t kRemembered = 3000;  // more than two rounds of every counter
    if (history_.size() > kRemembered) history_.pop_front();
  }

  hal::ProtectedDrives<kArms> controller_{kSource, kSource, hal::FrameFormat::kClassic};
  sim::JointDrives drives_{kArms, {.commands = kCommands}, hal::FrameFormat::kClassic};
  hal::Microseconds now_us_ = 0;
  std::map<std::uint32_t, std::uint8_t> last_counter_;
  std::deque<Frame> history_;
};

class Forger {
 public:
  explicit Forger(std::mt19937_64& random) : random_(random) {}

  // One attack: frames that come between two ticks.
  std::vector<Frame> frames(const HealthyBus& bus) {
    const auto& history = bus.history();
    const std::size_t size = below(64) + 1;
    const std::size_t from = below(history.size() - size);
    std::vector<Frame> forged(history.begin() + static_cast<std::ptrdiff_t>(from),
                              history.begin() + static_cast<std::ptrdiff_t>(from + size));
    switch (below(6)) {
      case 0:  // of everything that was there, in its order
        break;
      case 1: {  // of one message alone, so that its counters follow one another
        const std::uint32_t id = forged.front().id;
        std::erase_if(forged, [&](const Frame& frame) { return frame.id != id; });
        break;
      }
      case 2:  // noise
        for (Frame& frame : forged) {
          for (std::size_t i = 0; i < hal::kRecordLength; ++i) frame.data[i] = byte();
        }
        break;
      case 3:  // bits changed on the way
        for (Frame& frame : forged) flip(frame, below(16) + 1);
        break;
      case 4:  // another's content under the identifier of this one
        for (Frame& frame : forged) frame.id = history[below(history.size())].id;
        break;
      default:  // right but for the secret that every message's CRC begins with
        for (Frame& frame : forged) {
          const auto seed = static_cast<std::uint16_t>(below(2) == 0 ? 0xFFFF : 0);
          frame.data[hal::kCounterByte] = byte();
          const std::uint16_t crc = bitwise_crc(std::span(frame.data).first<6>(), seed);
          frame.data[6] = static_cast<std::uint8_t>(crc >> 8U);
          frame.data[7] = static_cast<std::uint8_t>(crc & 0xFFU);
        }
    }
    return forged;
  }

 private:
  std::size_t below(std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random_);
  }
  std::uint8_t byte() { return static_cast<std::uint8_t>(below(256)); }
  void flip(Frame& frame, std::size_t bits) {
    for (std::size_t i = 0; i < bits; ++i) {
      auto& byte = frame.data[below(hal::kRecordLength)];
      byte = static_cast<std::uint8_t>(byte ^ (1U << below(8)));
    }
  }

  std::mt19937_64& random_;
};

// GIVEN both ends in a healthy run WHEN a million forged or replayed frames come in bursts between
// the true ones THEN none of them is accepted at either end, and both trust the true ones again
// afterwards.
TEST(ForgedFrames, NoneOfAMillionIsAccepted) {
  std::mt19937_64 random = seeded_generator();
  Forger forger(random);
  HealthyBus bus;
  for (int i = 0; i < 600; ++i) bus.tick();
  const int wanted = repetitions(1'000'000);
  int forged = 0;
  int by_chance = 0;
  std::uint64_t accepted = 0;
  while (forged < wanted) {
    ASSERT_TRUE(bus.all_valid()) << "after " << forged << " forged frames";
    const int bursts = std::uniform_int_distribution<int>(1, 8)(random);
    for (int burst = 0; burst < bursts; ++burst) {
      for (const Frame& frame : forger.frames(bus)) {
        if (bus.could_be_next(frame)) {
          ++by_chance;
          continue;
        }
        const std::uint64_t before = bus.accepted();
        bus.inject(frame);
        accepted += bus.accepted() - before;
        ++forged;
      }
      bus.tick();
    }
    for (int i = 0; i < 12; ++i) bus.tick();
  }
  std::cout << forged << " forged or replayed frames, " << accepted << " accepted; " << by_chance
            << " left out that were what the true sender could send next\n";
  EXPECT_EQ(accepted, 0U);
}

}  // namespace
}  // namespace offnominal::test
