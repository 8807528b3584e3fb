#include "loop/stepped_controller.hpp"

#include "loop/in_space.hpp"

namespace offnominal::desk {

std::unique_ptr<SteppedController> make_stepped_controller(const SteppedSetup& setup,
                                                           Precision precision) {
  if (setup.robot.estimator.space == EstimatorSpace::kTorque) {
    return stepped_in_torque(setup, precision);
  }
  return stepped_in_acceleration(setup, precision);
}

}  // namespace offnominal::desk
