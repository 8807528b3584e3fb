// Controller and plant at the two ends of a wire, a tick at a time.
#pragma once

#include <memory>
#include <vector>

#include "loop/stepped_controller.hpp"
#include "offnominal/sim/bus/faulty_bus.hpp"
#include "offnominal/sim/bus/plant_node.hpp"
#include "sil/sil.hpp"

namespace offnominal::desk::sil {

/// What a run in lock-step consists of. Time is the wire's: every tick moves it by one period.
class BothEnds {
 public:
  /// Of a scenario that check_scenario() takes. `on_frame` sees every frame; all that is referred
  /// to has to outlive it. Throws InputError where the controller refuses the robot.
  BothEnds(const RobotDescription& robot, const Scenario& scenario, Wire& wire,
           const TappedPort::OnFrame& on_frame);

  BothEnds(const BothEnds&) = delete;
  BothEnds& operator=(const BothEnds&) = delete;
  ~BothEnds() = default;

  /// Ticks until the controller is armed. Throws InputError where that does not come about.
  void start();
  void tick();

  /// From now on these faults and no others, with their times on plant().time_s(). False, and
  /// nothing changed, where the plant cannot change its own.
  [[nodiscard]] bool set_faults(const std::vector<sim::FaultEvent>& faults);

  /// No drive gives a commanded torque any more.
  [[nodiscard]] bool is_safe() const {
    return plant_.started() && !plant_.drives().any_in_torque_mode();
  }
  [[nodiscard]] SteppedController& controller() { return *controller_; }
  [[nodiscard]] const SteppedController& controller() const { return *controller_; }
  [[nodiscard]] const sim::PlantNode& plant() const { return plant_; }
  [[nodiscard]] const MotionAt& motion() const { return motion_; }
  [[nodiscard]] hal::Microseconds now_us() const { return now_us_; }
  [[nodiscard]] hal::BusState controller_bus() const { return controller_bus_.state(); }
  [[nodiscard]] hal::BusState plant_bus() const { return plant_bus_.state(); }

 private:
  using Bus = sim::FaultyBus<BusPort>;

  hal::Microseconds period_us_;
  const RobotDescription& robot_;
  MotionAt motion_;
  Wire& wire_;
  TappedPort controller_tap_;
  TappedPort plant_tap_;
  sim::PlantNode plant_;
  Bus controller_bus_;
  Bus plant_bus_;
  BusPortOf<Bus&> controller_port_{controller_bus_};
  std::unique_ptr<SteppedController> controller_;
  hal::Microseconds now_us_ = 0;
};

}  // namespace offnominal::desk::sil
