#include "loop/stepped_controller.hpp"

#include <string>

#include "common/error.hpp"
#include "robot/chain_of.hpp"

namespace offnominal::desk {

std::unique_ptr<SteppedController> make_stepped_controller(const SteppedSetup& setup,
                                                           Precision precision) {
  const int joints = setup.robot.joint_count();
  if (precision == Precision::kFloat) {
    return with_joint_count(
        joints, [&]<int N>() { return detail::make_stepped_controller_of<N, float>(setup); });
  }
  if (joints == 2) return detail::make_stepped_controller_of<2, double>(setup);
  throw InputError({"robot " + setup.robot.name, "",
                    "double precision for " + std::to_string(joints) + " joint(s)", "float",
                    "firmware computes in floats; in doubles the controller is compiled for two "
                    "joints, where the paper's results are compared"});
}

}  // namespace offnominal::desk
