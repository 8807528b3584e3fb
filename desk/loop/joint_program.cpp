#include "loop/joint_program.hpp"

#include "robot/chain_of.hpp"

namespace offnominal::desk {

std::unique_ptr<JointProgram> make_joint_program(const JointProgramSetup& setup) {
  return with_joint_count(setup.robot.joint_count(),
                          [&]<int N>() { return detail::make_program_of<N>(setup); });
}

}  // namespace offnominal::desk
