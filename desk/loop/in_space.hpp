// One controller of each space, compiled side by side.
#pragma once

#include <memory>

#include "loop/joint_program.hpp"
#include "loop/stepped_controller.hpp"

namespace offnominal::desk {

[[nodiscard]] std::unique_ptr<SteppedController> stepped_in_acceleration(const SteppedSetup& setup,
                                                                         Precision precision);
[[nodiscard]] std::unique_ptr<SteppedController> stepped_in_torque(const SteppedSetup& setup,
                                                                   Precision precision);
[[nodiscard]] std::unique_ptr<JointProgram> program_in_acceleration(const JointProgramSetup& setup);
[[nodiscard]] std::unique_ptr<JointProgram> program_in_torque(const JointProgramSetup& setup);

}  // namespace offnominal::desk
