// Where the frames of a live view come from: a run that is simulated, or a bus that is listened to.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <offnominal/controller/fault.hpp>
#include <offnominal/hal/bus/frame.hpp>
#include <offnominal/hal/messages.hpp>
#include <optional>
#include <string>
#include <vector>

#include "offnominal/sim/bus/fault_event.hpp"
#include "robot/robot.hpp"
#include "sil/sil.hpp"

namespace offnominal::desk::live {

using OnFrame = std::function<void(const hal::ReceivedFrame& frame)>;

/// One thread at a time uses it.
class Feed {
 public:
  virtual ~Feed() = default;

  /// Waits for the next frames, a few milliseconds at most, and hands over those that have come.
  /// Their times ascend as long as the feed lives, one begin after another.
  virtual void take(const OnFrame& on_frame) = 0;
  /// Time now, on the scale of the frames.
  [[nodiscard]] virtual hal::Microseconds now_us() const = 0;
  /// Why nothing comes any more, in words; empty: something may come.
  [[nodiscard]] virtual std::string ended() const = 0;
  /// Frames that came and were not handed over, for want of time.
  [[nodiscard]] virtual std::uint64_t overflow() const { return 0; }
  /// What keeps it from showing all there is, in words; empty: nothing.
  [[nodiscard]] virtual std::string remark() const { return {}; }
};

struct ControllerWord {
  hal::ControllerState state = hal::ControllerState::kInit;
  controller::Fault fault = controller::Fault::kNone;
  bool slows = false;  // its motion is slowed, as only a simulated one tells
};

/// A feed that is simulated: nothing real hears of what is done to it.
class Bench : public Feed {
 public:
  /// These faults and no others, from now on; their times are not read.
  virtual void set_faults(const std::vector<sim::FaultEvent>& faults) = 0;
  virtual void set_accommodation(bool on) = 0;
  /// From the start, healthy but for the scenario's own faults.
  virtual void begin_again() = 0;
  [[nodiscard]] virtual ControllerWord controller() const = 0;
};

/// As time goes by, or as fast as this machine can.
enum class Pace : std::uint8_t { kRealTime, kAtSpeed };

/// Controller and plant of a robot on an in-process bus. The plant is that of the scenario. Throws
/// InputError where the scenario cannot be run.
[[nodiscard]] std::unique_ptr<Bench> make_bench(const RobotDescription& robot,
                                                const sil::Scenario& scenario,
                                                Pace pace = Pace::kRealTime);

/// Listens to a CAN interface of the kernel; nothing that is made here can send. Throws InputError
/// where there is no such interface.
[[nodiscard]] std::unique_ptr<Feed> make_ears(const std::string& interface);

}  // namespace offnominal::desk::live
