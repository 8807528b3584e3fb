#include "loop/in_space.hpp"
#include "loop/stepped_controller_of.hpp"

namespace offnominal::desk {

std::unique_ptr<SteppedController> stepped_in_acceleration(const SteppedSetup& setup,
                                                           Precision precision) {
  return stepped_controller_in<AccelerationSpace>(setup, precision);
}

}  // namespace offnominal::desk
