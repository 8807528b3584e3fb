#pragma once

#include <memory>

#include "loop/joint_program.hpp"

namespace offnominal::desk {

/// Ticks on the machine's clock.
class RealTimeTimer final : public TickTimer {
 public:
  RealTimeTimer(realtime::Microseconds period_us, realtime::Microseconds phase_us)
      : timer_(period_us, phase_us) {}
  realtime::Tick wait() override { return timer_.wait(); }
  [[nodiscard]] realtime::Microseconds period_us() const override { return timer_.period_us(); }

 private:
  realtime::CycleTimer timer_;
};

}  // namespace offnominal::desk
