#include "loop/in_space.hpp"
#include "loop/joint_program_of.hpp"

namespace offnominal::desk {

std::unique_ptr<JointProgram> program_in_torque(const JointProgramSetup& setup) {
  return std::make_unique<JointProgramOf<TorqueSpace>>(setup);
}

}  // namespace offnominal::desk
