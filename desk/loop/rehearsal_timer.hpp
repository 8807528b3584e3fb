#pragma once

#include <array>
#include <memory>
#include <offnominal/hal/bus/in_process_bus.hpp>
#include <offnominal/realtime/control_loop.hpp>
#include <optional>
#include <span>
#include <utility>

#include "drives/drive_table.hpp"
#include "loop/joint_program.hpp"

namespace offnominal::desk {

// Healthy drives at the other end of an in-process bus, whose ticks take no time.
class RehearsalTimer final : public TickTimer {
 public:
  using Net = hal::InProcessNet<2>;
  using Positions = Vector<kRuntimeJoints, float>;
  // Ends what is not over by itself.
  RehearsalTimer(Net& net, realtime::LoopPanel& panel, realtime::Microseconds period_us,
                 std::unique_ptr<sim::Drives> drives, const Positions& positions)
      : net_(net),
        panel_(panel),
        port_(net.port(1)),
        period_us_(period_us),
        positions_(positions),
        drives_(std::move(drives)) {}
  realtime::Tick wait() override {
    constexpr int kMostTicks = 1000;
    if (++ticks_ == kMostTicks) panel_.end.store(true);
    now_us_ += period_us_;
    net_.set_time(now_us_);
    std::array<hal::ReceivedFrame, 2 * kMost> come;
    const std::size_t count = port_.receive(come);
    for (std::size_t i = 0; i < count; ++i) drives_->take(come[i]);
    drives_->tick(now_us_);
    const auto joints = static_cast<std::size_t>(positions_.size());
    std::array<std::optional<hal::EncoderReading>, kMost> readings;
    for (std::size_t j = 0; j < joints; ++j) {
      readings[j] = hal::EncoderReading{positions_[static_cast<Eigen::Index>(j)], 0, true};
    }
    std::array<hal::Frame, sim::Drives::kMostFrames> frames;
    const std::array<double, kMost> torques{};
    const std::size_t made = drives_->frames(std::span(readings).first(joints),
                                             std::span(torques).first(joints), frames);
    for (std::size_t i = 0; i < made; ++i) static_cast<void>(port_.send(frames[i], now_us_));
    return {now_us_, 0, 0};
  }
  [[nodiscard]] realtime::Microseconds period_us() const override { return period_us_; }

 private:
  static constexpr auto kMost = static_cast<std::size_t>(kMaxJoints);
  Net& net_;
  realtime::LoopPanel& panel_;
  Net::Port port_;
  realtime::Microseconds period_us_;
  Positions positions_;
  std::unique_ptr<sim::Drives> drives_;
  realtime::Microseconds now_us_ = 0;
  int ticks_ = 0;
};

}  // namespace offnominal::desk
