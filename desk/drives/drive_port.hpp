// The controller's side of any drive protocol and of any number of joints, so that a controller is
// compiled once for all.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <offnominal/hal/drive_protocol.hpp>
#include <span>
#include <utility>

#include "drives/drive_protocols.hpp"
#include "drives/drive_table.hpp"

namespace offnominal::desk {

namespace detail {
template <typename... Rows>
constexpr std::size_t most_outgoing(std::tuple<Rows...>* /*rows*/) {
  return std::max({Rows::Protocol::template Drives<hal::kAnyJoints>::kMaxOutgoing...});
}
}  // namespace detail

class DrivePort {
 public:
  static constexpr std::size_t kJoints = hal::kAnyJoints;
  static constexpr std::size_t kMaxOutgoing =
      detail::most_outgoing(static_cast<DriveProtocols*>(nullptr));

  virtual ~DrivePort() = default;
  virtual hal::Status take(const hal::ReceivedFrame& received) = 0;
  virtual hal::Status overhear(const hal::ReceivedFrame& received) = 0;
  [[nodiscard]] virtual hal::JointFeedback feedback(std::size_t joint,
                                                    hal::Microseconds now_us) const = 0;
  virtual std::size_t outgoing(std::span<const hal::TorqueCommand> commands,
                               const hal::Heartbeat& heartbeat, std::span<hal::Frame> into) = 0;
  virtual bool report(const hal::Diagnosis& found, hal::Frame& into) = 0;
  virtual bool report(const hal::FaultReport& fault, hal::Frame& into) = 0;
  [[nodiscard]] virtual hal::Microseconds drive_max_age_us() const = 0;
  [[nodiscard]] virtual bool stop_seen() const = 0;
  virtual void clear_stop() = 0;
  [[nodiscard]] virtual hal::DriveCounts counts() const = 0;
};
static_assert(hal::OverheardProtocol<DrivePort>);

template <hal::OverheardProtocol Drives>
class DrivePortOf final : public DrivePort {
 public:
  explicit DrivePortOf(Drives drives) : drives_(std::move(drives)) {}
  hal::Status take(const hal::ReceivedFrame& received) override { return drives_.take(received); }
  hal::Status overhear(const hal::ReceivedFrame& received) override {
    return drives_.overhear(received);
  }
  [[nodiscard]] hal::JointFeedback feedback(std::size_t joint,
                                            hal::Microseconds now_us) const override {
    return drives_.feedback(joint, now_us);
  }
  std::size_t outgoing(std::span<const hal::TorqueCommand> commands,
                       const hal::Heartbeat& heartbeat, std::span<hal::Frame> into) override {
    return drives_.outgoing(commands, heartbeat, into);
  }
  bool report(const hal::Diagnosis& found, hal::Frame& into) override {
    return drives_.report(found, into);
  }
  bool report(const hal::FaultReport& fault, hal::Frame& into) override {
    return drives_.report(fault, into);
  }
  [[nodiscard]] hal::Microseconds drive_max_age_us() const override {
    return drives_.drive_max_age_us();
  }
  [[nodiscard]] bool stop_seen() const override { return drives_.stop_seen(); }
  void clear_stop() override { drives_.clear_stop(); }
  [[nodiscard]] hal::DriveCounts counts() const override { return drives_.counts(); }

 private:
  Drives drives_;
};

/// Of settings of as many joints, 1 to kMaxJoints.
[[nodiscard]] std::unique_ptr<DrivePort> make_drive_port(const DriveSettings& settings,
                                                         std::size_t joints,
                                                         const hal::DriveLink& link);

}  // namespace offnominal::desk
